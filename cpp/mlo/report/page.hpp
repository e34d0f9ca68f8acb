#pragma once

#include <optional>
#include <span>
#include <string>

#include "mlo/evaluation/trajectory_plots.hpp"
#include "mlo/report/run_folder.hpp"

namespace mlo {

/// A run and, where there is truth, how far it is from it.
struct ReportedRun {
  RunFolder run;
  std::optional<TrajectoryEvaluation> errors;
  std::string truth_name;  ///< where the truth came from
};

/// One HTML page about the runs, side by side: what they did, errors, times per stage, maps from above,
/// warnings. All is in the page itself; nothing is loaded from elsewhere. The same runs give the same bytes.
std::string report_page(std::span<const ReportedRun> runs);

/// Text with what HTML would read as markup replaced.
std::string html_escaped(std::string_view text);

}  // namespace mlo
