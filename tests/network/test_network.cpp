#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "mlo/core/error.hpp"
#include "mlo/network/network.hpp"
#include "network/tiny_network.hpp"

namespace mlo {
namespace {

using ::testing::HasSubstr;

const NetworkArchitecture kTiny = test::tiny_architecture();

TEST(Network, OutputHasARowPerCandidate) {
  const Network network(test::random_weights(kTiny));
  const NetworkOutput output = network(test::random_input(500));
  EXPECT_EQ(output.candidates.rows(), 32);
  EXPECT_EQ(output.class_logits.rows(), 32);
  EXPECT_EQ(output.class_logits.cols(), 2);
  EXPECT_EQ(output.box_codes.cols(), kTiny.box_code.size());
  EXPECT_TRUE(output.box_codes.allFinite());
}

// Layer by layer as it is written in the paper, without folding, sharing or blocks.
RowMatrix plain_sequence(const TensorFile& file, const SequenceSpec& spec, const RowMatrix& input) {
  const auto vector = [&](const std::string& name) {
    const std::vector<float>& values = file.tensors.at(name).values;
    return Eigen::RowVectorXf(
        Eigen::Map<const Eigen::RowVectorXf>(values.data(), static_cast<Eigen::Index>(values.size())));
  };
  RowMatrix rows = input;
  for (std::size_t k = 0; k + 1 < spec.channels.size(); ++k) {
    const Eigen::RowVectorXf flat = vector(weight_name(spec, k) + ".weight");
    const Eigen::Map<const RowMatrix> weight(flat.data(), spec.channels[k + 1], spec.channels[k]);
    rows = (rows * weight.transpose()).eval();
    if (spec.plain_end && k + 2 == spec.channels.size())
      return rows.rowwise() + vector(weight_name(spec, k) + ".bias");
    const std::string norm = norm_name(spec, k);
    for (Eigen::Index i = 0; i < rows.rows(); ++i) {
      rows.row(i) =
          ((rows.row(i) - vector(norm + ".running_mean")).array() /
               (vector(norm + ".running_var").array() + 1e-5F).sqrt() * vector(norm + ".weight").array() +
           vector(norm + ".bias").array())
              .max(0.0F);
    }
  }
  return rows;
}

TEST(Network, EqualsItsDefinition) {
  const TensorFile file = test::random_weights(kTiny);
  const NetworkSequences sequences = sequences_of(kTiny);
  const NetworkInput input = test::random_input(300);
  PointRows points = input.points;
  RowMatrix features = input.features;
  const auto describe = [&](const PointRows& centers, const SetAbstractionSpec& spec,
                            const NetworkSequences::Layer& layer) {
    RowMatrix all(centers.rows(), 0);
    for (std::size_t s = 0; s < spec.scales.size(); ++s) {
      const ScaleSpec& scale = spec.scales[s];
      const Groups groups =
          query_balls(points, centers,
                      {static_cast<float>(scale.inner_radius_m), static_cast<float>(scale.radius_m),
                       static_cast<std::size_t>(scale.neighbours)});
      RowMatrix pooled = RowMatrix::Zero(centers.rows(), scale.channels.back());
      for (Eigen::Index i = 0; i < centers.rows(); ++i) {
        for (std::uint32_t m = groups.begins[static_cast<std::size_t>(i)];
             m < groups.begins[static_cast<std::size_t>(i) + 1]; ++m) {
          RowMatrix member(1, 3 + features.cols());
          member << points.row(groups.members[m]) - centers.row(i), features.row(groups.members[m]);
          pooled.row(i) = pooled.row(i).cwiseMax(plain_sequence(file, layer.scales[s], member));
        }
      }
      const RowMatrix before = all;
      all.resize(centers.rows(), before.cols() + pooled.cols());
      all << before, pooled;
    }
    return layer.aggregate.channels.empty() ? all : plain_sequence(file, layer.aggregate, all);
  };
  for (std::size_t k = 0; k < kTiny.layers.size(); ++k) {
    const std::vector<std::uint32_t> chosen = sample(points, features, kTiny.layers[k].samples);
    PointRows centers(static_cast<Eigen::Index>(chosen.size()), 3);
    for (std::size_t i = 0; i < chosen.size(); ++i)
      centers.row(static_cast<Eigen::Index>(i)) = points.row(chosen[i]);
    features = describe(centers, kTiny.layers[k], sequences.layers[k]);
    points = centers;
  }
  const RowMatrix shifts = plain_sequence(file, sequences.vote, features.topRows(32));
  const PointRows candidates = points.topRows(32) + limited_shifts(shifts, kTiny.vote.max_shift_m);
  const RowMatrix described = plain_sequence(
      file, sequences.shared, describe(candidates, kTiny.candidate_layer, sequences.candidates));

  const NetworkOutput output = Network(file)(input);
  EXPECT_LT((output.candidates - candidates).cwiseAbs().maxCoeff(), 1e-4F);
  EXPECT_LT((output.class_logits - plain_sequence(file, sequences.classes, described)).cwiseAbs().maxCoeff(),
            1e-3F);
  EXPECT_LT((output.box_codes - plain_sequence(file, sequences.boxes, described)).cwiseAbs().maxCoeff(),
            1e-3F);
}

TEST(Network, IsTheSameForAnyNumberOfThreads) {
  const Network network(test::random_weights(kTiny));
  const NetworkInput input = test::random_input(500);
  const NetworkOutput many = network(input);
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const NetworkOutput alone = network(input);
  EXPECT_EQ(many.candidates, alone.candidates);
  EXPECT_EQ(many.class_logits, alone.class_logits);
  EXPECT_EQ(many.box_codes, alone.box_codes);
}

TEST(Network, HandlesNoPointsAndOne) {
  const Network network(test::random_weights(kTiny));
  EXPECT_EQ(network(test::random_input(0)).candidates.rows(), 0);
  const NetworkOutput one = network(test::random_input(1));
  EXPECT_EQ(one.candidates.rows(), 1);
  EXPECT_TRUE(one.box_codes.allFinite());
}

TEST(Network, ShiftsAreLimited) {
  RowMatrix shifts(2, 3);
  shifts << 9.0F, -9.0F, 0.5F, 1.0F, 2.0F, -7.0F;
  PointRows expected(2, 3);
  expected << 3.0F, -3.0F, 0.5F, 1.0F, 2.0F, -2.0F;
  EXPECT_EQ(limited_shifts(shifts, {3.0, 3.0, 2.0}), expected);
}

void expect_refusal(const TensorFile& file, const std::string& word) {
  try {
    const Network network(file);
    FAIL() << "taken";
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr(word));
  }
}

TEST(Network, RefusesWeightsThatDoNotFit) {
  const std::string name = "point_head.cls_layers.0.weight";
  TensorFile file = test::random_weights(kTiny);
  file.tensors.erase(name);
  expect_refusal(file, name);
  file = test::random_weights(kTiny);
  file.tensors.at(name).shape = {1, 2};
  expect_refusal(file, name);
  file = test::random_weights(kTiny);
  file.tensors.at(name).values[3] = std::numeric_limits<float>::quiet_NaN();
  expect_refusal(file, "not finite");
}

}  // namespace
}  // namespace mlo
