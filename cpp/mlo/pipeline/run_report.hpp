#pragma once

#include <string>

#include "mlo/pipeline/run.hpp"

namespace mlo {

/// run.json: version, input, configuration, times per stage (mean, p50, p99, max), counters, warnings, peak
/// memory.
std::string to_json(const Dataset& dataset, const PipelineConfig& config, const RunSummary& summary);

/// Mean and order statistics of times [ms]; all 0 when there are none.
struct TimeStatistics {
  double mean_ms = 0.0;
  double p50_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
};
TimeStatistics statistics(std::vector<double> times_ms);

/// Statistics of one stage, and of whole scans.
TimeStatistics stage_statistics(const RunSummary& summary, Stage stage);
TimeStatistics scan_statistics(const RunSummary& summary);

/// The most memory that this process has had so far [MiB].
double peak_memory_mib();

}  // namespace mlo
