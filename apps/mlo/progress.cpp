#include "apps/mlo/progress.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iostream>
#include <utility>

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace mlo::apps {
namespace {

constexpr double kBarPeriod_s = 0.1;
constexpr double kLinePeriod_s = 5.0;
constexpr double kLineStep = 0.1;
constexpr std::size_t kBarWidth = 30;

double seconds_now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Progress::Style style_of_stderr() {
  if (!spdlog::should_log(spdlog::level::info)) return Progress::Style::none;
  return isatty(STDERR_FILENO) != 0 ? Progress::Style::bar : Progress::Style::lines;
}

std::string bar(std::size_t done, std::size_t total) {
  const std::size_t filled = total == 0 ? kBarWidth : std::min(kBarWidth, kBarWidth * done / total);
  return "[" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "] ";
}

std::string clock_text(double seconds) {
  const auto whole = static_cast<long>(std::lround(seconds));
  if (whole >= 3600) return fmt::format("{}:{:02}:{:02}", whole / 3600, whole / 60 % 60, whole % 60);
  return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

}  // namespace

std::string progress_text(const std::string& what, std::size_t done, std::size_t total, double elapsed_s) {
  const std::size_t percent = total == 0 ? 100 : 100 * done / total;
  std::string text = fmt::format("{}/{} {} ({}%)", done, total, what, percent);
  if (done == 0 || !(elapsed_s > 0.0)) return text;
  const double rate = static_cast<double>(done) / elapsed_s;
  text += fmt::format(", {:.1f} {}/s", rate, what);
  if (done < total) text += fmt::format(", {} left", clock_text(static_cast<double>(total - done) / rate));
  return text;
}

Progress::Progress(std::string what, std::size_t total, Style style, std::ostream& out, Clock now_s)
    : what_(std::move(what)),
      total_(total),
      style_(style),
      out_(out),
      now_s_(std::move(now_s)),
      start_s_(now_s_()) {}

Progress::Progress(std::string what, std::size_t total)
    : Progress(std::move(what), total, style_of_stderr(), std::cerr, seconds_now) {}

bool Progress::is_due(std::size_t done, double elapsed_s) const {
  if (done == last_done_) return false;
  if (done >= total_) return true;
  if (style_ == Style::bar) return elapsed_s - last_s_ >= kBarPeriod_s;
  const double step = kLineStep * static_cast<double>(total_);
  return elapsed_s - last_s_ >= kLinePeriod_s && static_cast<double>(done - last_done_) >= step;
}

void Progress::update(std::size_t done) {
  if (style_ == Style::none) return;
  const double elapsed_s = now_s_() - start_s_;
  if (!is_due(done, elapsed_s)) return;
  last_s_ = elapsed_s;
  last_done_ = done;
  const std::string text = progress_text(what_, done, total_, elapsed_s);
  if (style_ == Style::bar) {
    out_ << "\r\x1b[K" << bar(done, total_) << text << std::flush;
    line_open_ = true;
  } else {
    out_ << text << std::endl;
  }
}

void Progress::finish() {
  if (line_open_) out_ << std::endl;
  line_open_ = false;
}

}  // namespace mlo::apps
