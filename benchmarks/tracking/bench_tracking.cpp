#include <benchmark/benchmark.h>

#include "mlo/tracking/tracker.hpp"
#include "tracking/boxes.hpp"
#include "tracking/car_scan.hpp"

namespace mlo {
namespace {

/// Cars in two rows, 8 m apart.
std::vector<ObjectPoints> parked_cars(std::size_t count) {
  std::vector<ObjectPoints> objects;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t row = i / 2;
    const double x_m = 8.0 + 8.0 * static_cast<double>(row);
    const double y_m = i % 2 == 0 ? 4.0 : -4.0;
    ObjectPoints object;
    object.detection = test::car(x_m, y_m);
    const SE3 L = object.detection.box.T_lidar_object();
    object.points = test::as_scan(test::seen_from_lidar(L, 0.01, static_cast<unsigned>(i)));
    objects.push_back(std::move(object));
  }
  return objects;
}

/// One scan with range(0) cars, boxes alone.
void track_boxes(benchmark::State& state) {
  std::vector<Detection> detections;
  for (const ObjectPoints& object : parked_cars(static_cast<std::size_t>(state.range(0)))) {
    detections.push_back(object.detection);
  }
  Tracker tracker({});
  for (auto _ : state) benchmark::DoNotOptimize(tracker.process(detections, SE3(), 0.1));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(track_boxes)->Arg(1)->Arg(10)->Arg(40)->Unit(benchmark::kMicrosecond);

/// The same with their points, by each kind of estimate.
void track_points(benchmark::State& state, SgfMode mode) {
  const std::vector<ObjectPoints> objects = parked_cars(static_cast<std::size_t>(state.range(0)));
  TrackingConfig config;
  config.sgf.mode = mode;
  Tracker tracker(config);
  const SweepTiming timing{.motion_compensated = true};
  for (auto _ : state) benchmark::DoNotOptimize(tracker.process(objects, SE3(), 0.1, timing));
}
BENCHMARK_CAPTURE(track_points, fusion, SgfMode::fusion)
    ->Arg(1)
    ->Arg(10)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(track_points, semantic, SgfMode::semantic)
    ->Arg(10)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(track_points, geometry, SgfMode::geometry)
    ->Arg(10)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
