#include <cmath>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "detection/made_scan.hpp"
#include "mlo/detection/cluster_detector.hpp"

namespace mlo {
namespace {

/// A street of 80 m with 24 parked cars between walls: some 100 000 points.
test::MadeScan make_street() {
  std::vector<Box3d> cars;
  for (int k = 0; k < 24; ++k) {
    cars.push_back(
        test::standing(-36.0 + 3.1 * k, k % 2 == 0 ? 5.5 : -5.5, {4.1, 1.75, 1.5}, 0.05 * (k % 5)));
  }
  test::MadeScan scan;
  scan.add_ground(cars, 60.0);
  for (const Box3d& car : cars) scan.add_car(car);
  for (double x = -40.0; x < 40.0; x += 0.04) {
    for (double z = -1.5; z < 5.0; z += 0.3) {
      scan.add({x, 9.0, z});
      scan.add({x, -9.0, z});
    }
  }
  return scan;
}

void detect_clusters_of_street(benchmark::State& state) {
  const test::MadeScan scan = make_street();
  state.counters["points"] = static_cast<double>(scan.points.size());
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    arena.execute([&] { benchmark::DoNotOptimize(detect_clusters(scan.points, scan.is_ground, {})); });
  }
}
BENCHMARK(detect_clusters_of_street)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
