#include <limits>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "mlo/pipeline/prepare.hpp"

namespace mlo {
namespace {

// As many points as an HDL-64E returns; some are too near or too far, and one in a thousand is not finite.
Scan random_scan() {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> metres(-90.0F, 90.0F);
  Scan scan;
  scan.points.resize(120000);
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    scan.points[i].p_lidar = {metres(random), metres(random), 0.05F * metres(random)};
    if (i % 1000 == 0) scan.points[i].p_lidar.x() = std::numeric_limits<float>::quiet_NaN();
  }
  return scan;
}

/// Cropping of a scan, with and without correction of the elevations, to the whole view or the camera's.
void prepare_scan(benchmark::State& state) {
  const Scan scan = random_scan();
  SensorConfig sensor;
  sensor.vertical_correction_deg = state.range(0) != 0 ? 0.205 : 0.0;
  InputConfig input;
  input.roi = state.range(1) != 0 ? RegionOfInterest::camera : RegionOfInterest::full;
  for (auto _ : state) benchmark::DoNotOptimize(prepare(scan, sensor, input).points.size());
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * scan.points.size()));
}
BENCHMARK(prepare_scan)->ArgNames({"corrected", "camera"})->ArgsProduct({{0, 1}, {0, 1}});

}  // namespace
}  // namespace mlo
