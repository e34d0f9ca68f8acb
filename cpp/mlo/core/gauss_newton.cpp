#include "mlo/core/gauss_newton.hpp"

#include <Eigen/Eigenvalues>

namespace mlo {

void NormalEquations::add(double residual, const Vector6d& jacobian, double w) {
  H.noalias() += (w * jacobian) * jacobian.transpose();
  g.noalias() += (w * residual) * jacobian;
  cost += w * residual * residual;
  weight += w;
  ++count;
}

NormalEquations& NormalEquations::operator+=(const NormalEquations& other) {
  H += other.H;
  g += other.g;
  cost += other.cost;
  weight += other.weight;
  count += other.count;
  return *this;
}

GaussNewtonStep solve(const NormalEquations& sums, double min_curvature, double lever_arm_m,
                      const Eigen::Matrix<bool, 6, 1>& active) {
  using Vector6d = NormalEquations::Vector6d;
  GaussNewtonStep step;
  if (sums.weight <= 0.0) {
    step.degenerate_directions = static_cast<int>(active.count());
    return step;
  }
  // Scaling by 1 / lever arm turns radians into the metres they move a point at that distance.
  Vector6d scale = active.cast<double>();
  scale.tail<3>() /= lever_arm_m;
  const NormalEquations::Matrix6d H = scale.asDiagonal() * (sums.H / sums.weight) * scale.asDiagonal();
  const Vector6d g = scale.asDiagonal() * (sums.g / sums.weight);
  const Eigen::SelfAdjointEigenSolver<NormalEquations::Matrix6d> eigen(H);
  const int fixed = 6 - static_cast<int>(active.count());
  int flat = 0;
  for (int i = 0; i < 6; ++i) {
    const double curvature = eigen.eigenvalues()(i);
    if (!(curvature >= min_curvature) || curvature <= 0.0) {
      ++flat;  // fixed parameters have zero curvature and are counted here too
      continue;
    }
    const Vector6d direction = eigen.eigenvectors().col(i);
    step.xi -= direction * (direction.dot(g) / curvature);
  }
  step.degenerate_directions = flat - fixed;
  step.xi = scale.asDiagonal() * step.xi;
  return step;
}

}  // namespace mlo
