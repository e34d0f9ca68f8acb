#pragma once

#include <cstddef>

#include <Eigen/Core>

namespace mlo {

/// Sums of a weighted least-squares problem in the six parameters of a pose ([translation; rotation]).
struct NormalEquations {
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  using Vector6d = Eigen::Matrix<double, 6, 1>;

  Matrix6d H = Matrix6d::Zero();  ///< sum of w J^T J
  Vector6d g = Vector6d::Zero();  ///< sum of w J^T r
  double cost = 0.0;              ///< sum of w r^2
  double weight = 0.0;            ///< sum of w
  std::size_t count = 0;

  /// Adds a scalar residual with Jacobian d residual / d xi and weight.
  void add(double residual, const Vector6d& jacobian, double w);
  NormalEquations& operator+=(const NormalEquations& other);
};

/// A Gauss-Newton step and what the problem's curvature says about it.
struct GaussNewtonStep {
  NormalEquations::Vector6d xi = NormalEquations::Vector6d::Zero();
  int degenerate_directions = 0;  ///< directions without enough curvature; xi has no part in them
};

/// Solves H xi = -g where the data constrains xi. A direction whose curvature (eigenvalue of H / weight, with
/// rotations scaled by lever_arm_m so that units agree) is below min_curvature is left as it is
/// (solution remapping, Zhang et al., ICRA 2016).
/// @param active  which parameters may move; the others stay fixed
GaussNewtonStep solve(const NormalEquations& sums, double min_curvature, double lever_arm_m,
                      const Eigen::Matrix<bool, 6, 1>& active = Eigen::Matrix<bool, 6, 1>::Constant(true));

}  // namespace mlo
