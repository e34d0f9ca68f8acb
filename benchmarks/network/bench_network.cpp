#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "detection/made_street.hpp"
#include "mlo/detection/network_detector.hpp"
#include "mlo/detection/network_input.hpp"
#include "mlo/network/point_operations.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

/// The network that comes with mlo: its time does not depend on what its weights are.
const Network& shipped_network() {
  static const Network network(test::random_weights(small_architecture()));
  return network;
}

void detect_in_street_by_3dssd(benchmark::State& state) {
  const test::MadeScan scan = test::make_street();
  state.counters["points"] = static_cast<double>(scan.points.size());
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    arena.execute([&] {
      benchmark::DoNotOptimize(detect_with_network(scan.points, scan.is_ground, shipped_network(), {}));
    });
  }
}
BENCHMARK(detect_in_street_by_3dssd)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

NetworkInput street_input() {
  const test::MadeScan scan = test::make_street();
  const NetworkInputSpec spec = small_architecture().input;
  return network_input(
      network_points(scan.points, scan.is_ground, NetworkFrame(scan.points, scan.is_ground, spec), spec),
      spec);
}

// The parts of the first layer, and all of the network.
void prepare_input(benchmark::State& state) {
  const test::MadeScan scan = test::make_street();
  const NetworkInputSpec spec = small_architecture().input;
  for (auto _ : state) {
    const NetworkFrame frame(scan.points, scan.is_ground, spec);
    benchmark::DoNotOptimize(network_points(scan.points, scan.is_ground, frame, spec));
  }
}
BENCHMARK(prepare_input)->Unit(benchmark::kMillisecond);

void sample_first_layer(benchmark::State& state) {
  const NetworkInput input = street_input();
  const std::vector<SamplingSpec> samples = small_architecture().layers.front().samples;
  for (auto _ : state) benchmark::DoNotOptimize(sample(input.points, input.features, samples));
}
BENCHMARK(sample_first_layer)->Unit(benchmark::kMillisecond);

void query_first_layer(benchmark::State& state) {
  const NetworkInput input = street_input();
  const SetAbstractionSpec layer = small_architecture().layers.front();
  const std::vector<std::uint32_t> chosen = sample(input.points, input.features, layer.samples);
  PointRows centers(static_cast<Eigen::Index>(chosen.size()), 3);
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    centers.row(static_cast<Eigen::Index>(i)) = input.points.row(chosen[i]);
  }
  tbb::task_arena arena(1);
  for (auto _ : state) {
    arena.execute([&] {
      for (const ScaleSpec& scale : layer.scales) {
        benchmark::DoNotOptimize(query_balls(input.points, centers,
                                             {.radius_m = static_cast<float>(scale.radius_m),
                                              .neighbours = static_cast<std::size_t>(scale.neighbours)}));
      }
    });
  }
}
BENCHMARK(query_first_layer)->UseRealTime()->Unit(benchmark::kMillisecond);

void infer(benchmark::State& state) {
  const NetworkInput input = street_input();
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) arena.execute([&] { benchmark::DoNotOptimize(shipped_network()(input)); });
}
BENCHMARK(infer)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
