#include <cmath>
#include <numbers>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "mlo/core/sensor.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/perception/perceive.hpp"
#include "mlo/perception/scan_lines.hpp"

namespace mlo {
namespace {

/// A full HDL-64E sweep (133 000 points) in a court of 60 m x 24 m with a pillar every 6 m along its walls.
Scan make_scan() {
  constexpr int kColumns = 2083;
  constexpr double kHeight = 1.73;
  Scan scan;
  const std::vector<double> elevations = hdl64e().elevations_deg();
  for (std::size_t ring = 0; ring < elevations.size(); ++ring) {
    const double elevation = elevations[ring] * std::numbers::pi / 180.0;
    for (int column = 0; column < kColumns; ++column) {
      const double azimuth = 2.0 * std::numbers::pi * column / kColumns;
      const double wall = std::min(30.0 / std::abs(std::cos(azimuth)), 12.0 / std::abs(std::sin(azimuth)));
      const bool pillar = std::fmod(std::abs(wall * std::cos(azimuth)), 6.0) < 0.5;
      const double ground = elevation < 0.0 ? kHeight / std::tan(-elevation) : wall;
      const double range = std::min(pillar ? wall - 0.5 : wall, ground);
      Point point;
      point.p_lidar =
          Eigen::Vector3d(range * std::cos(azimuth), range * std::sin(azimuth), range * std::tan(elevation))
              .cast<float>();
      point.ring = static_cast<std::uint16_t>(ring);
      scan.points.push_back(point);
    }
  }
  return scan;
}

std::vector<Detection> make_detections() {
  std::vector<Detection> detections;
  for (int k = 0; k < 20; ++k) {
    detections.push_back(
        {.box = {{-25.0 + 2.5 * k, k % 2 == 0 ? 6.0 : -6.0, -0.9}, {4.2, 1.8, 1.6}, 0.1 * k}});
  }
  return detections;
}

/// Runs the body over and over on range(0) threads.
template <class Body>
void run_on_threads(benchmark::State& state, const Body& body) {
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) arena.execute([&] { benchmark::DoNotOptimize(body()); });
}

void perceive_scan(benchmark::State& state) {
  const Scan scan = make_scan();
  const std::vector<Detection> detections = make_detections();
  run_on_threads(state, [&] { return perceive(scan, detections, {}); });
}
BENCHMARK(perceive_scan)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void segment_ground_of_scan(benchmark::State& state) {
  const Scan scan = make_scan();
  run_on_threads(state, [&] { return segment_ground(scan.points, {}); });
}
BENCHMARK(segment_ground_of_scan)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void measure_lines_of_scan(benchmark::State& state) {
  const Scan scan = make_scan();
  const ScanLines lines = group_lines(scan.points);
  run_on_threads(state, [&] { return measure_lines(scan.points, lines); });
}
BENCHMARK(measure_lines_of_scan)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
