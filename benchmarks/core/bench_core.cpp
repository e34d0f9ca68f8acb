#include <random>
#include <vector>

#include <benchmark/benchmark.h>
#include <tbb/task_arena.h>

#include "mlo/core/gauss_newton.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/core/se3.hpp"

namespace mlo {
namespace {

constexpr std::size_t kNumPoses = 1000;

std::vector<SE3::Tangent> random_tangents(std::size_t count) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  std::vector<SE3::Tangent> tangents(count);
  for (SE3::Tangent& xi : tangents) {
    xi = SE3::Tangent::NullaryExpr([&] { return uniform(random); });
  }
  return tangents;
}

void exp_and_log(benchmark::State& state) {
  const std::vector<SE3::Tangent> tangents = random_tangents(kNumPoses);
  for (auto _ : state) {
    for (const SE3::Tangent& xi : tangents) benchmark::DoNotOptimize(SE3::exp(xi).log());
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * tangents.size()));
}
BENCHMARK(exp_and_log);

void compose(benchmark::State& state) {
  const std::vector<SE3::Tangent> tangents = random_tangents(kNumPoses);
  std::vector<SE3> poses;
  for (const SE3::Tangent& xi : tangents) poses.push_back(SE3::exp(xi));
  for (auto _ : state) {
    SE3 product;
    for (const SE3& pose : poses) product = product * pose;
    benchmark::DoNotOptimize(product);
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * poses.size()));
}
BENCHMARK(compose);

/// Normal equations of range(0) residuals on range(1) threads: the inner loop of every registration.
void sum_normal_equations(benchmark::State& state) {
  const std::vector<SE3::Tangent> jacobians = random_tangents(static_cast<std::size_t>(state.range(0)));
  tbb::task_arena arena(static_cast<int>(state.range(1)));
  for (auto _ : state) {
    arena.execute([&] {
      benchmark::DoNotOptimize(parallel_sum<NormalEquations>(
          jacobians.size(), [&](NormalEquations& sums, std::size_t i) { sums.add(0.1, jacobians[i], 1.0); }));
    });
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * jacobians.size()));
}
BENCHMARK(sum_normal_equations)->ArgsProduct({{1000, 10000}, {1, 2}})->UseRealTime();

}  // namespace
}  // namespace mlo
