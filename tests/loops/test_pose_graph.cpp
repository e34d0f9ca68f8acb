#include <numbers>

#include <gtest/gtest.h>

#include "mlo/loops/pose_graph.hpp"

namespace mlo {
namespace {

/// Corner after corner of a square spiral staircase, twice round.
std::vector<SE3> staircase(std::size_t count) {
  const SE3 step(so3_exp({0.02, -0.01, 0.5 * std::numbers::pi}), {10.0, 0.0, 0.5});
  std::vector<SE3> poses{SE3(so3_exp({0.1, 0.2, 0.3}), {1.0, 2.0, 3.0})};
  while (poses.size() < count) poses.push_back(poses.back() * step);
  return poses;
}

PoseGraphEdge edge_between(const std::vector<SE3>& poses, std::size_t from, std::size_t to) {
  return {
      .from = from, .to = to, .T_from_to = poses[from].inverse() * poses[to], .sd_m = 0.1, .sd_rad = 0.01};
}

double largest_error(const std::vector<SE3>& a, const std::vector<SE3>& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    largest = std::max(largest, (a[i].inverse() * b[i]).log().cwiseAbs().maxCoeff());
  }
  return largest;
}

TEST(PoseGraph, ConsistentEdgesAreMetFromAFarStart) {
  const std::vector<SE3> truth = staircase(9);
  std::vector<PoseGraphEdge> edges;
  for (std::size_t i = 1; i < truth.size(); ++i) edges.push_back(edge_between(truth, i - 1, i));
  edges.push_back(edge_between(truth, 0, 8));
  edges.push_back(edge_between(truth, 6, 2));  // against the order of the nodes
  std::vector<SE3> start = truth;
  for (std::size_t i = 1; i < start.size(); ++i) {
    const double k = static_cast<double>(i);
    start[i] =
        SE3::exp((SE3::Tangent() << 0.5 * k, -0.3 * k, 0.2, 0.02, -0.03 * k, 0.05 * k).finished()) * start[i];
  }
  const std::vector<SE3> found = optimize_pose_graph(start, edges);
  EXPECT_LT(largest_error(found, truth), 1e-7);
  EXPECT_EQ(found[0].matrix(), truth[0].matrix());
}

// On a line, an error of the loop is spread evenly over equal edges.
TEST(PoseGraph, ALoopIsSharedByItsEdges) {
  std::vector<SE3> poses;
  for (int i = 0; i <= 10; ++i)
    poses.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(i, 0.0, 0.0));
  std::vector<PoseGraphEdge> edges;
  for (std::size_t i = 1; i < poses.size(); ++i) edges.push_back(edge_between(poses, i - 1, i));
  PoseGraphEdge loop = edge_between(poses, 0, 10);
  loop.T_from_to = SE3(Eigen::Quaterniond::Identity(), {10.0 + 1.1, 0.0, 0.0});
  edges.push_back(loop);
  const std::vector<SE3> found = optimize_pose_graph(poses, edges);
  // Eleven equal springs and 1.1 m: each gives 0.1 m.
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_NEAR(found[i].translation().x(), 1.1 * static_cast<double>(i), 1e-6);
  }
}

TEST(PoseGraph, NothingToFit) {
  EXPECT_TRUE(optimize_pose_graph({}, {}).empty());
  const std::vector<SE3> one = staircase(1);
  EXPECT_EQ(optimize_pose_graph(one, {})[0].matrix(), one[0].matrix());
  const std::vector<SE3> apart = staircase(4);  // node 3 has no edge
  const std::vector<PoseGraphEdge> edges{edge_between(apart, 0, 1), edge_between(apart, 1, 2)};
  EXPECT_LT(largest_error(optimize_pose_graph(apart, edges), apart), 1e-9);
}

}  // namespace
}  // namespace mlo
