#include "mlo/tracking/ego_from_boxes.hpp"

#include <cmath>

#include <Eigen/Cholesky>

namespace mlo {

SE3 ego_from_boxes(std::span<const BoxPair> pairs, const SE3& T_map_lidar_predicted,
                   const EgoChange& change) {
  constexpr int kIterations = 8;
  constexpr double kKernel2 = 9.0;  // squared residual over variance at which a pair's pull fades
  const Eigen::Vector3d prior(1.0 / (change.translation_m * change.translation_m),
                              1.0 / (change.translation_m * change.translation_m),
                              1.0 / (change.rotation_rad * change.rotation_rad));
  const Eigen::Vector2d origin_m = T_map_lidar_predicted.translation().head<2>();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // x, y [m], yaw [rad] about the predicted place
  for (int iteration = 0; iteration < kIterations; ++iteration) {
    Eigen::Matrix3d H = prior.asDiagonal();
    Eigen::Vector3d g = prior.cwiseProduct(offset);
    const Eigen::Rotation2Dd turn(offset.z());
    for (const BoxPair& pair : pairs) {
      const Eigen::Vector3d p(pair.measured_lidar_m.x(), pair.measured_lidar_m.y(), 0.0);
      const Eigen::Vector2d lever_m =
          turn * Eigen::Vector2d((T_map_lidar_predicted.rotation() * p).head<2>());
      const Eigen::Vector2d residual_m = origin_m + offset.head<2>() + lever_m - pair.predicted_map_m;
      const double information = 1.0 / (pair.sd_m * pair.sd_m);
      const double fade = kKernel2 / (kKernel2 + information * residual_m.squaredNorm());
      Eigen::Matrix<double, 2, 3> J;
      J << 1.0, 0.0, -lever_m.y(), 0.0, 1.0, lever_m.x();
      const double weight = information * fade * fade;
      H += weight * J.transpose() * J;
      g += weight * J.transpose() * residual_m;
    }
    const Eigen::Vector3d step = H.ldlt().solve(g);
    offset -= step;
    if (step.norm() < 1e-6) break;
  }
  const SE3 turn({std::cos(0.5 * offset.z()), 0.0, 0.0, std::sin(0.5 * offset.z())}, Eigen::Vector3d::Zero());
  return {turn.rotation() * T_map_lidar_predicted.rotation(),
          T_map_lidar_predicted.translation() + Eigen::Vector3d(offset.x(), offset.y(), 0.0)};
}

}  // namespace mlo
