#include <algorithm>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/core/box_overlap.hpp"
#include "mlo/core/error.hpp"
#include "mlo/learning/learner.hpp"
#include "mlo/network/box_code.hpp"
#include "mlo/network/network.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

const NetworkArchitecture kTiny = test::tiny_architecture();

/// Two cars and a pedestrian on a field with bushes, in the network's frame.
BatchExample field(unsigned seed = 1) {
  const std::vector<TargetBox> boxes{{{{6.0, 2.0, 0.75}, {4.2, 1.8, 1.5}, 0.3}, 0},
                                     {{{-5.0, -4.0, 0.75}, {4.0, 1.7, 1.5}, 2.2}, 0},
                                     {{{3.0, -6.0, 0.85}, {0.7, 0.6, 1.7}, 0.0}, 1}};
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-0.5, 0.5);
  std::vector<Point> points;
  const auto add = [&](const Eigen::Vector3d& p) { points.push_back({.p_lidar = p.cast<float>()}); };
  for (const TargetBox& target : boxes) {
    for (int i = 0; i < 60; ++i) {
      Eigen::Vector3d p = Eigen::Vector3d(uniform(random), uniform(random), uniform(random)) * 0.98;
      p[i % 2] = p[i % 2] > 0.0 ? 0.49 : -0.49;  // on a side
      add(target.box.T_lidar_object() * p.cwiseProduct(target.box.size_lwh_m));
    }
  }
  for (int i = 0; i < 200; ++i)
    add({20.0 * uniform(random), 20.0 * uniform(random), 0.3 + 0.4 * uniform(random)});
  std::ranges::shuffle(points, random);
  return make_batch_example(points, boxes, kTiny);
}

TEST(Learner, LearnsAnExampleByHeart) {
  Learner learner(kTiny, 3, {});
  const std::vector<BatchExample> batch{field()};
  const LossTerms first = learner.step(batch, 0.005);
  LossTerms last;
  for (int i = 0; i < 250; ++i) last = learner.step(batch, 0.005 * (1.0 - i / 250.0));
  EXPECT_LT(last.total(), 0.25 * first.total());
  // Normalised by running statistics, as it is used, and by the code without LibTorch.
  for (int i = 0; i < 500; ++i) learner.step(batch, 1e-6);
  const NetworkOutput output = Network(learner.weights())(batch.front().input);
  const std::vector<Detection> found = decode_boxes(output, kTiny, 0.5);
  for (const TargetBox& target : batch.front().boxes) {
    EXPECT_TRUE(std::ranges::any_of(
        found,
        [&](const Detection& detection) {
          return detection.object_class == kTiny.classes[static_cast<std::size_t>(target.class_index)] &&
                 intersection_over_union(detection.box, target.box) > 0.5;
        }))
        << "box at " << target.box.center_lidar_m.transpose();
  }
}

TEST(Learner, AnswersAsTheNetworkDoes) {
  Learner learner(kTiny, 3, {});
  const std::vector<BatchExample> batch{field(1), field(2)};
  for (int i = 0; i < 5; ++i) learner.step(batch, 0.003);
  const NetworkOutput with_torch = learner(batch.front());
  const NetworkOutput without = Network(learner.weights())(batch.front().input);
  EXPECT_LT((with_torch.candidates - without.candidates).cwiseAbs().maxCoeff(), 1e-3F);
  EXPECT_LT((with_torch.class_logits - without.class_logits).cwiseAbs().maxCoeff(), 1e-2F);
  EXPECT_LT((with_torch.box_codes - without.box_codes).cwiseAbs().maxCoeff(), 1e-2F);
}

TEST(Learner, GivesTheSameBytesForTheSameSeed) {
  const auto trained = [](std::uint64_t seed) {
    Learner learner(kTiny, seed, {});
    const std::vector<BatchExample> batch{field()};
    for (int i = 0; i < 3; ++i) learner.step(batch, 0.003);
    return learner.state();
  };
  const TensorFile state = trained(3);
  EXPECT_EQ(state, trained(3));
  EXPECT_NE(state, trained(4));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  EXPECT_EQ(state, trained(3));
}

TEST(Learner, GoesOnFromItsState) {
  const std::vector<BatchExample> batch{field()};
  Learner through(kTiny, 3, {});
  for (int i = 0; i < 3; ++i) through.step(batch, 0.003);
  Learner resumed(kTiny, 77, {});
  resumed.restore(through.state());
  EXPECT_EQ(resumed.state(), through.state());
  through.step(batch, 0.003);
  resumed.step(batch, 0.003);
  EXPECT_EQ(resumed.state(), through.state());
}

TEST(Learner, RefusesStatesOfOthers) {
  Learner learner(kTiny, 3, {});
  EXPECT_THROW(learner.restore(learner.weights()), InputError);  // no optimiser
  NetworkArchitecture wider = kTiny;
  wider.head.shared = {40};
  EXPECT_THROW(learner.restore(Learner(wider, 3, {}).state()), InputError);
  EXPECT_THROW(learner.begin_with(Learner(wider, 3, {}).weights()), InputError);
}

TEST(Learner, TakesScansWithoutObjectsAndWithOnePoint) {
  Learner learner(kTiny, 3, {});
  const std::vector<Point> one{{.p_lidar = {1.0F, 2.0F, 0.5F}}};
  const std::vector<BatchExample> batch{make_batch_example(one, {}, kTiny)};
  EXPECT_TRUE(std::isfinite(learner.step(batch, 0.003).total()));
  for (const auto& [name, tensor] : learner.weights().tensors) {
    EXPECT_TRUE(std::ranges::all_of(tensor.values, [](float value) { return std::isfinite(value); })) << name;
  }
}

}  // namespace
}  // namespace mlo
