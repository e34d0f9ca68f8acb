#include "mlo/pipeline/run_report.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace mlo {
namespace {

using nlohmann::ordered_json;

ordered_json to_json_object(const TimeStatistics& times) {
  return {{"mean_ms", times.mean_ms},
          {"p50_ms", times.p50_ms},
          {"p99_ms", times.p99_ms},
          {"max_ms", times.max_ms}};
}

// Nearest-rank percentile of sorted values.
double percentile(const std::vector<double>& sorted, double share) {
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
  return sorted[std::clamp<std::size_t>(rank, 1, sorted.size()) - 1];
}

}  // namespace

TimeStatistics statistics(std::vector<double> times_ms) {
  if (times_ms.empty()) return {};
  std::sort(times_ms.begin(), times_ms.end());
  TimeStatistics result;
  result.mean_ms =
      std::accumulate(times_ms.begin(), times_ms.end(), 0.0) / static_cast<double>(times_ms.size());
  result.p50_ms = percentile(times_ms, 0.50);
  result.p99_ms = percentile(times_ms, 0.99);
  result.max_ms = times_ms.back();
  return result;
}

TimeStatistics stage_statistics(const RunSummary& summary, Stage stage) {
  std::vector<double> times_ms;
  for (StageTimes times : summary.times) times_ms.push_back(times[stage]);
  return statistics(std::move(times_ms));
}

TimeStatistics scan_statistics(const RunSummary& summary) {
  std::vector<double> times_ms;
  for (const StageTimes& times : summary.times) times_ms.push_back(times.total_ms());
  return statistics(std::move(times_ms));
}

double peak_memory_mib() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;  // Linux counts KiB
}

std::string to_json(const Dataset& dataset, const PipelineConfig& config, const RunSummary& summary) {
  ordered_json stages;
  for (std::size_t i = 0; i < kNumStages; ++i) {
    stages[std::string(kStageNames[i])] = to_json_object(stage_statistics(summary, static_cast<Stage>(i)));
  }
  stages["scan"] = to_json_object(scan_statistics(summary));
  const ordered_json report{
      {"version", MLO_VERSION},
      {"input",
       {{"folder", dataset.root.string()}, {"format", dataset.format}, {"sequence", dataset.sequence}}},
      {"scans", summary.scans},
      {"processed", summary.processed},
      {"skipped", summary.skipped},
      {"predicted", summary.predicted},
      {"degenerate", summary.degenerate},
      {"odometry_degenerate", summary.odometry_degenerate},
      {"failed_consistency_checks", summary.failed_checks},
      {"invalid_points", summary.invalid_points},
      {"boxes_from", summary.boxes_from},
      {"detections", summary.detections},
      {"path_m", summary.path_m},
      {"static_map_points", summary.map_points},
      {"loops", summary.loops},
      {"interrupted", summary.interrupted},
      {"times", stages},
      {"peak_memory_mib", peak_memory_mib()},
      {"warnings", summary.warnings},
      {"configuration", to_yaml(config)}};
  // File names need not be UTF-8, which JSON is.
  return report.dump(2, ' ', false, ordered_json::error_handler_t::replace) + "\n";
}

}  // namespace mlo
