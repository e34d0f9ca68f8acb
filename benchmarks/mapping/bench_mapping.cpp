#include <array>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "mlo/mapping/local_map.hpp"
#include "mlo/mapping/refinement.hpp"

namespace mlo {
namespace {

constexpr float kHalfWidth = 20.0F;  // of a street between two walls [m]
constexpr float kHalfLength = 60.0F;
constexpr float kLidarHeight = 1.7F;
constexpr float kNoise = 0.02F;

// Points on the ground, the walls of a street and one wall across it, so that all directions are known.
std::vector<Eigen::Vector3f> street_points(std::size_t count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1.0F, 1.0F);
  std::normal_distribution<float> noise(0.0F, kNoise);
  std::vector<Eigen::Vector3f> points;
  points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const float along = kHalfLength * unit(random);
    const float across = kHalfWidth * unit(random);
    const float up = 3.0F * unit(random) + 3.0F - kLidarHeight;
    switch (i % 4) {
      case 0:
        points.emplace_back(along, kHalfWidth + noise(random), up);
        break;
      case 1:
        points.emplace_back(along, -kHalfWidth + noise(random), up);
        break;
      case 2:
        points.emplace_back(kHalfLength + noise(random), across, up);
        break;
      default:
        points.emplace_back(along, across, noise(random) - kLidarHeight);
        break;
    }
  }
  return points;
}

LocalMap street_map() {
  LocalMap map(LocalMapConfig{});
  map.insert(street_points(200000, 1));
  return map;
}

/// The candidates of a scan into a map that knows the place already, and into an empty one.
void insert(benchmark::State& state) {
  const std::vector<Eigen::Vector3f> points = street_points(40000, 2);
  const LocalMap known = state.range(0) != 0 ? street_map() : LocalMap(LocalMapConfig{});
  for (auto _ : state) {
    state.PauseTiming();
    LocalMap map = known;
    state.ResumeTiming();
    map.insert(points);
    benchmark::DoNotOptimize(map.num_voxels());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * points.size()));
}
BENCHMARK(insert)->ArgName("known")->Arg(0)->Arg(1);

void nearest(benchmark::State& state) {
  const LocalMap map = street_map();
  const std::vector<Eigen::Vector3f> queries = street_points(10000, 3);
  for (auto _ : state) {
    for (const Eigen::Vector3f& query : queries) {
      benchmark::DoNotOptimize(map.nearest(query, static_cast<int>(state.range(0)), 0.8F).count);
    }
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * queries.size()));
}
BENCHMARK(nearest)->ArgName("k")->Arg(1)->Arg(8);

/// A whole registration of 10000 points that starts 0.3 m and 1 degree off, on range(0) threads.
void register_scan(benchmark::State& state) {
  const LocalMap map = street_map();
  std::vector<FeaturePoint> scan;
  for (const Eigen::Vector3f& p : street_points(10000, 4)) {
    scan.push_back({.p_lidar = p, .sweep_fraction = 0.5F});
  }
  const std::array<RefinementTerm, 1> terms{{{scan, &map, ExpectedShape::plane}}};
  RefinementGuess guess;
  guess.T_previous_current = SE3::exp((SE3::Tangent() << 0.2, 0.2, 0.1, 0.0, 0.0, 0.0175).finished());
  guess.timing.motion_compensated = true;
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  int iterations = 0;
  for (auto _ : state) {
    const PoseEstimate estimate = arena.execute([&] { return refine(terms, guess, RefinementConfig{}); });
    if (estimate.status != EstimateStatus::converged) state.SkipWithError("did not converge");
    iterations = estimate.iterations;
  }
  state.counters["iterations"] = iterations;
}
BENCHMARK(register_scan)->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
