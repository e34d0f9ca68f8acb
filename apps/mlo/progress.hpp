#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>

namespace mlo::apps {

/// How far a job over a known number of scans has come: a bar with rate and time left on a terminal, a plain
/// line every 10 % or 5 s (whichever is later) elsewhere, nothing when messages are off.
class Progress {
 public:
  enum class Style { none, lines, bar };
  using Clock = std::function<double()>;  ///< seconds, from any origin

  /// @param what  unit of the count, as in "scans"
  Progress(std::string what, std::size_t total, Style style, std::ostream& out, Clock now_s);
  /// Writes to stderr, in the style that fits it and the log level.
  Progress(std::string what, std::size_t total);
  ~Progress() { finish(); }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// To be called after each scan; writes when there is something new to say.
  void update(std::size_t done);
  /// Ends the bar's line, so that other output can follow; also done at the end of its life.
  void finish();

 private:
  bool is_due(std::size_t done, double elapsed_s) const;

  std::string what_;
  std::size_t total_;
  Style style_;
  std::ostream& out_;
  Clock now_s_;
  double start_s_;
  double last_s_ = 0.0;
  std::size_t last_done_ = 0;
  bool line_open_ = false;
};

/// "120/154 scans (77%), 31.2 scans/s, 0:01 left"; the rate is left out as long as it is not known.
std::string progress_text(const std::string& what, std::size_t done, std::size_t total, double elapsed_s);

}  // namespace mlo::apps
