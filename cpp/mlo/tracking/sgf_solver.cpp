#include "mlo/tracking/sgf_solver.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace mlo {
namespace {

using Matrix6d = NormalEquations::Matrix6d;
using Vector6d = NormalEquations::Vector6d;

/// A residual of a point that finds no voxel, in standard deviations: leaving the target must cost something.
constexpr double kUnmatched = 5.0;

/// Cost of a squared residual in units of its variance, and its derivative, the weight: Cauchy's kernel,
/// which makes the weight fade beyond `kernel` standard deviations.
struct Robust {
  double cost = 0.0;
  double weight = 1.0;
};
Robust robust(double squared, const SgfConfig& config) {
  if (config.kernel <= 0.0) return {squared, 1.0};
  const double scale = config.kernel * config.kernel;
  return {scale * std::log1p(squared / scale), 1.0 / (1.0 + squared / scale)};
}

/// Adds a vector residual with information W, times a factor.
void add(NormalEquations& sums, const VectorResidual& residual, const Eigen::Matrix3d& W, double factor,
         const SgfConfig& config) {
  const Robust part = robust(residual.value.dot(W * residual.value), config);
  const Eigen::Matrix<double, 6, 3> JtW = residual.jacobian.transpose() * (factor * part.weight * W);
  sums.H.noalias() += JtW * residual.jacobian;
  sums.g.noalias() += JtW * residual.value;
  sums.cost += factor * part.cost;
  ++sums.count;
}

class Cost {
 public:
  Cost(const SgfProblem& problem, const SgfConfig& config) : problem_(problem), config_(config) {
    has_boxes_ = config.mode != SgfMode::geometry && problem.previous_box && problem.current_box;
    has_points_ = config.mode != SgfMode::semantic && problem.target != nullptr && !problem.target->empty();
    if (!has_boxes_) return;
    previous_planes_ = planes_of(*problem.previous_box);
    current_planes_ = planes_of(*problem.current_box);
    if (config.centred) origin_ = problem.previous_box->center_lidar_m;
  }

  NormalEquations at(const SE3& H) const {
    NormalEquations sums;
    if (has_points_) add_points(H, sums);
    num_points_ = sums.count;
    if (has_boxes_) add_planes(H, sums);
    return sums;
  }
  std::size_t num_points() const { return num_points_; }  ///< matched in the last call of at()
  bool has_boxes() const { return has_boxes_; }

 private:
  void add_points(const SE3& H, NormalEquations& sums) const {
    const RelativeMotion motion(H);
    const auto num_points = static_cast<double>(problem_.points.size());
    // Points of one surface err together: many of them are worth no more than effective_points.
    const double scale = config_.printed_weights ? (2.0 - problem_.confidence) / (2.0 * num_points)
                                                 : std::min(1.0, config_.effective_points / num_points);
    for (const ShapedPoint& point : problem_.points) {
      const ObjectTarget::Voxel* voxel = problem_.target->find(motion.move(point));
      if (voxel == nullptr) {
        sums.cost += scale * robust(kUnmatched * kUnmatched, config_).cost;
        continue;
      }
      const Eigen::Matrix3d information = point_covariance(point, *voxel, H).inverse();
      const double count = config_.printed_weights ? static_cast<double>(voxel->count) : 1.0;
      add(sums, point_residual(point, voxel->mean, motion), information, scale * count, config_);
    }
  }

  /// Whitening of a face's closest point: along its normal by how well that face is known, sideways by the
  /// heading.
  Eigen::Matrix3d information_of(std::size_t face, const Eigen::Vector3d& F) const {
    const auto axis = static_cast<Eigen::Index>(face / 2);
    const double along_sd_m = std::sqrt(2.0) * problem_.center_sd_m(axis);  // two faces tell of one centre
    const double lever_m = std::max(0.3, 0.5 * problem_.previous_box->size_lwh_m(axis));
    const double aside_sd_m = 2.0 * problem_.yaw_sd_rad * lever_m;  // four faces tell of one heading
    const Eigen::Matrix3d normal_part = F * F.transpose();
    return normal_part / (along_sd_m * along_sd_m) +
           (Eigen::Matrix3d::Identity() - normal_part) / (aside_sd_m * aside_sd_m);
  }

  void add_planes(const SE3& H, NormalEquations& sums) const {
    for (std::size_t i = 0; i < previous_planes_.size(); ++i) {
      const VectorResidual residual = plane_residual(previous_planes_[i], current_planes_[i], H, origin_);
      if (config_.printed_weights) {
        const double weight = problem_.confidence / (2.0 * static_cast<double>(previous_planes_.size()));
        add(sums, residual, Eigen::Matrix3d::Identity(), weight, config_);
      } else {
        add(sums, residual, information_of(i, H.rotation() * current_planes_[i].normal), 1.0, config_);
      }
    }
  }

  const SgfProblem& problem_;
  const SgfConfig& config_;
  bool has_boxes_ = false;
  bool has_points_ = false;
  std::array<BoxPlane, 6> previous_planes_;
  std::array<BoxPlane, 6> current_planes_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  mutable std::size_t num_points_ = 0;
};

/// Moves perturbations from the lidar's origin to the object's place, where rotation and translation part.
SE3::Adjoint at_place(const Eigen::Vector3d& place) {
  return SE3(Eigen::Quaterniond::Identity(), -place).adjoint();
}

/// Covariance at the object, with the directions that nothing determines counted.
void set_covariance(const NormalEquations& sums, const Eigen::Vector3d& place, PoseEstimate& estimate) {
  constexpr double kMinInformation = 1.0;  // a standard deviation of 1 m or 1 rad: as good as unknown
  const SE3::Adjoint from_place = at_place(-place);
  const Matrix6d information = from_place.transpose() * sums.H * from_place;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> eigen(information);
  for (int i = 0; i < 6; ++i) {
    const double value = eigen.eigenvalues()(i);
    if (value < kMinInformation) ++estimate.degenerate_directions;
    const Vector6d v = eigen.eigenvectors().col(i);
    estimate.covariance += v * v.transpose() / std::max(value, 1e-2 * kMinInformation);
  }
}

Eigen::Vector3d place_of(const SgfProblem& problem) {
  if (problem.previous_box) return problem.previous_box->center_lidar_m;
  if (problem.points.empty()) return Eigen::Vector3d::Zero();
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const ShapedPoint& point : problem.points) sum += point.p_lidar;
  return sum / static_cast<double>(problem.points.size());
}

}  // namespace

PoseEstimate estimate_relative_motion(const SgfProblem& problem, const SE3& H_guess,
                                      const SgfConfig& config) {
  PoseEstimate estimate;
  estimate.T_target_source = H_guess;
  const Cost cost(problem, config);
  NormalEquations sums = cost.at(H_guess);
  estimate.num_matches = cost.num_points();
  if (!cost.has_boxes() && cost.num_points() < static_cast<std::size_t>(config.min_points)) {
    estimate.status = EstimateStatus::too_few_matches;
    return estimate;
  }
  const SE3::Adjoint to_place = at_place(place_of(problem));
  SE3 H = H_guess;
  double damping = 1e-3;
  bool converged = false;
  for (; estimate.iterations < config.max_iterations && !converged; ++estimate.iterations) {
    Matrix6d A = sums.H;
    A.diagonal() += damping * sums.H.diagonal() + Vector6d::Constant(1e-9);
    const Vector6d xi = -A.ldlt().solve(sums.g);
    if (!xi.allFinite()) break;
    const SE3 moved = SE3::exp(xi) * H;
    const NormalEquations trial = cost.at(moved);
    const Vector6d step = to_place * xi;
    converged = step.head<3>().norm() < config.converged_m && step.tail<3>().norm() < config.converged_m;
    if (trial.count > 0 && trial.cost <= sums.cost * (1.0 + 1e-9)) {
      H = moved;
      sums = trial;
      damping = std::max(1e-6, 0.1 * damping);
    } else {
      damping *= 10.0;
      if (damping > 1e6) converged = true;
    }
  }
  cost.at(H);
  estimate.T_target_source = H;
  estimate.num_matches = cost.num_points();
  set_covariance(sums, place_of(problem), estimate);
  estimate.status = estimate.degenerate_directions > 0 ? EstimateStatus::degenerate
                    : converged                        ? EstimateStatus::converged
                                                       : EstimateStatus::max_iterations;
  return estimate;
}

}  // namespace mlo
