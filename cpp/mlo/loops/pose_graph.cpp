#include "mlo/loops/pose_graph.hpp"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace mlo {
namespace {

using Vector6d = SE3::Tangent;
using Matrix6d = SE3::Adjoint;
using Sparse = Eigen::SparseMatrix<double>;

constexpr int kMaxIterations = 50;
constexpr double kSmallStep = 1e-9;
constexpr double kFirstDamping = 1e-6;
constexpr double kMaxDamping = 1e6;

struct EdgeError {
  Vector6d value;  // over the standard deviations
  Matrix6d to;     // d value / d xi of the node that the edge leads to; the other's is its negative
};

EdgeError error_of(const PoseGraphEdge& edge, const std::vector<SE3>& poses) {
  const SE3& T_map_to = poses[edge.to];
  const Vector6d e = (edge.T_from_to.inverse() * poses[edge.from].inverse() * T_map_to).log();
  // Both nodes move on the left: exp(xi_from)^-1 exp(xi_to) stands between the poses and passes through T_to;
  // log(E exp(d)) = log(E) + (1 + ad/2 + ...) d.
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = skew(e.tail<3>());
  ad.bottomRightCorner<3, 3>() = skew(e.tail<3>());
  ad.topRightCorner<3, 3>() = skew(e.head<3>());
  Vector6d inverse_sd;
  inverse_sd << Eigen::Vector3d::Constant(1.0 / edge.sd_m), Eigen::Vector3d::Constant(1.0 / edge.sd_rad);
  const Matrix6d jacobian = (Matrix6d::Identity() + 0.5 * ad) * T_map_to.inverse().adjoint();
  return {inverse_sd.cwiseProduct(e), inverse_sd.asDiagonal() * jacobian};
}

double cost_of(std::span<const PoseGraphEdge> edges, const std::vector<SE3>& poses) {
  double cost = 0.0;
  for (const PoseGraphEdge& edge : edges) cost += error_of(edge, poses).value.squaredNorm();
  return cost;
}

struct NormalSums {
  Sparse H;
  Eigen::VectorXd g;
};

// The first node has no part in it: column 0 is that of the second.
NormalSums linearize(std::span<const PoseGraphEdge> edges, const std::vector<SE3>& poses) {
  const auto size = static_cast<Eigen::Index>(6 * (poses.size() - 1));
  std::vector<Eigen::Triplet<double>> entries;
  NormalSums sums{Sparse(size, size), Eigen::VectorXd::Zero(size)};
  const auto add = [&](std::size_t row_node, std::size_t col_node, const Matrix6d& block) {
    if (row_node == 0 || col_node == 0) return;
    for (int i = 0; i < 6; ++i) {
      for (int k = 0; k < 6; ++k) {
        entries.emplace_back(static_cast<int>(6 * (row_node - 1)) + i,
                             static_cast<int>(6 * (col_node - 1)) + k, block(i, k));
      }
    }
  };
  for (const PoseGraphEdge& edge : edges) {
    const EdgeError error = error_of(edge, poses);
    const Matrix6d block = error.to.transpose() * error.to;
    const Vector6d gradient = error.to.transpose() * error.value;
    add(edge.from, edge.from, block);
    add(edge.to, edge.to, block);
    add(edge.from, edge.to, -block);
    add(edge.to, edge.from, -block);
    if (edge.to > 0) sums.g.segment<6>(static_cast<Eigen::Index>(6 * (edge.to - 1))) += gradient;
    if (edge.from > 0) sums.g.segment<6>(static_cast<Eigen::Index>(6 * (edge.from - 1))) -= gradient;
  }
  // The whole diagonal, for the damping: a node may have no edge.
  for (int i = 0; i < size; ++i) entries.emplace_back(i, i, 0.0);
  sums.H.setFromTriplets(entries.begin(), entries.end());
  return sums;
}

std::vector<SE3> moved(const std::vector<SE3>& poses, const Eigen::VectorXd& step) {
  std::vector<SE3> result = poses;
  for (std::size_t i = 1; i < poses.size(); ++i) {
    const Vector6d xi = step.segment<6>(static_cast<Eigen::Index>(6 * (i - 1)));
    result[i] = SE3::exp(xi) * poses[i];
  }
  return result;
}

}  // namespace

std::vector<SE3> optimize_pose_graph(std::vector<SE3> T_map_node, std::span<const PoseGraphEdge> edges) {
  if (T_map_node.size() < 2 || edges.empty()) return T_map_node;
  double cost = cost_of(edges, T_map_node);
  double damping = kFirstDamping;
  for (int i = 0; i < kMaxIterations && damping < kMaxDamping; ++i) {
    NormalSums sums = linearize(edges, T_map_node);
    sums.H.diagonal() += damping * (sums.H.diagonal() + Eigen::VectorXd::Ones(sums.g.size()));
    const Eigen::SimplicialLDLT<Sparse> solver(sums.H);
    const Eigen::VectorXd step = solver.solve(-sums.g);
    std::vector<SE3> next = moved(T_map_node, step);
    const double next_cost = cost_of(edges, next);
    if (solver.info() != Eigen::Success || !(next_cost <= cost)) {
      damping *= 10.0;
      continue;
    }
    T_map_node = std::move(next);
    cost = next_cost;
    damping *= 0.1;
    if (step.cwiseAbs().maxCoeff() < kSmallStep) break;
  }
  return T_map_node;
}

}  // namespace mlo
