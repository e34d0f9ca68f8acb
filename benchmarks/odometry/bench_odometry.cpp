#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "mlo/odometry/two_step_ego.hpp"
#include "odometry/scene.hpp"

namespace mlo {
namespace {

constexpr std::size_t kMaxCandidates = 10000;

// Two looks at a street, 1 m and 2 degrees apart.
struct StreetPair {
  SE3 T_previous_current{so3_exp({0.0, 0.0, 0.035}), {1.0, 0.0, 0.0}};
  Percept previous;
  Percept current;

  StreetPair() {
    test::View view{.T_world_lidar = test::pose_above_ground(0.0, 0.0, 0.0),
                    .T_previous_current = T_previous_current,
                    .noise_m = 0.02};
    previous = observe(test::street(), view);
    view.T_world_lidar = view.T_world_lidar * T_previous_current;
    view.seed += 1;
    current = observe(test::street(), view);
  }
  ReferenceScan reference() const {
    return make_reference_scan(previous, SweepMotion(T_previous_current, 0.5), kMaxCandidates);
  }
};

/// The search structures of a scan on range(0) threads.
void build_reference_scan(benchmark::State& state) {
  const StreetPair pair;
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    arena.execute([&] { benchmark::DoNotOptimize(pair.reference()); });
  }
}
BENCHMARK(build_reference_scan)->Arg(1)->Arg(2)->UseRealTime()->Unit(benchmark::kMillisecond);

void run_estimate(benchmark::State& state, const OdometryConfig& config, bool predicted) {
  const StreetPair pair;
  const ReferenceScan reference = pair.reference();
  std::optional<SE3> guess;
  if (predicted) guess = pair.T_previous_current * SE3(Eigen::Quaterniond::Identity(), {0.05, 0.0, 0.0});
  tbb::task_arena arena(static_cast<int>(state.range(0)));
  for (auto _ : state) {
    arena.execute(
        [&] { benchmark::DoNotOptimize(estimate_ego(pair.current, reference, guess, {}, config, 1)); });
  }
}

OdometryConfig with_check(bool check, OdometryConfig::Estimator estimator) {
  OdometryConfig config;
  config.consistency_check = check;
  config.estimator = estimator;
  return config;
}
constexpr auto kTwoStep = OdometryConfig::Estimator::two_step;
constexpr auto kJoint = OdometryConfig::Estimator::joint;

BENCHMARK_CAPTURE(run_estimate, two_step, with_check(true, kTwoStep), true)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run_estimate, two_step_unchecked, with_check(false, kTwoStep), true)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run_estimate, joint, with_check(true, kJoint), true)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(run_estimate, first_scans, with_check(true, kTwoStep), false)
    ->Arg(1)
    ->Arg(2)
    ->UseRealTime()
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace mlo
