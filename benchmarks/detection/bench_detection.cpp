#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "detection/made_street.hpp"
#include "mlo/detection/cluster_detector.hpp"

namespace mlo {
namespace {

void detect_clusters_of_street(benchmark::State& state) {
  const test::MadeScan scan = test::make_street();
  state.counters["points"] = static_cast<double>(scan.points.size());
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    arena.execute([&] { benchmark::DoNotOptimize(detect_clusters(scan.points, scan.is_ground, {})); });
  }
}
BENCHMARK(detect_clusters_of_street)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
