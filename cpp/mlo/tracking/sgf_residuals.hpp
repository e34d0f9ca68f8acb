#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <tsl/robin_map.h>

#include "mlo/core/box.hpp"
#include "mlo/core/gauss_newton.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/core/types.hpp"
#include "mlo/core/voxel_grid.hpp"

// Residuals of the semantic-geometric fusion (SGF): the relative motion H of an object maps its points, seen
// in the lidar frame at the reference time of the current scan, to where they were at that of the previous
// one. Jacobians are with respect to xi = [translation; rotation] in exp(xi) * H.
namespace mlo {

using Matrix36 = Eigen::Matrix<double, 3, 6>;

/// n . p + d = 0 with unit n (docs/conventions.md).
struct BoxPlane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitX();
  double d_m = 0.0;
};

/// The faces of a box, normals outwards: front, back, left, right, top, bottom.
std::array<BoxPlane, 6> planes_of(const Box3d& box);

struct VectorResidual {
  Eigen::Vector3d value = Eigen::Vector3d::Zero();
  Matrix36 jacobian = Matrix36::Zero();
};

/// Difference of closest points of the previous plane and the current one moved by H, Eq. (8)-(12), about
/// `origin`: the lidar's, zero, as printed; the box's centre makes a yaw error count the same at any range.
VectorResidual plane_residual(const BoxPlane& previous, const BoxPlane& current, const SE3& H,
                              const Eigen::Vector3d& origin);

/// A point of an object with the shape around it.
struct ShapedPoint {
  Eigen::Vector3d p_lidar = Eigen::Vector3d::Zero();
  double share = 1.0;  ///< part of the motion H that lies between its time and the previous reference time
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  ///< [m^2]
  static void archive(auto& self, auto& bytes) { bytes(self.p_lidar, self.share, self.covariance); }
};

/// Points of one object, thinned to at most max_points, with the covariances of their neighbourhoods, whose
/// eigenvalues become thick_m^2 across a surface and wide_m^2 along it, as in voxelised G-ICP (Koide et al.,
/// ICRA 2021). In the order of the points.
struct ShapeConfig {
  double thin_voxel_m = 0.08;
  std::size_t max_points = 150;
  int neighbours = 8;
  double thick_m = 0.04;
  double wide_m = 0.25;
};
std::vector<ShapedPoint> shaped_points(std::span<const Eigen::Vector3d> points, const ShapeConfig& config);

/// The previous points of an object as Gaussians on voxels.
class ObjectTarget {
 public:
  struct Voxel {
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  ///< mean of its points'
    int count = 0;
  };

  ObjectTarget() = default;
  /// @param points  undistorted, at the previous reference time
  ObjectTarget(std::span<const ShapedPoint> points, double voxel_m);

  /// The voxel of a point, or where that is empty the nearest of its six neighbours; nothing if all are
  /// empty.
  const Voxel* find(const Eigen::Vector3d& p) const;
  bool empty() const { return voxels_.empty(); }

 private:
  double voxel_m_ = 0.3;
  tsl::robin_map<VoxelKey, Voxel, VoxelKeyHash> voxels_;
};

/// H and its interpolation, Eq. (5) by its physical meaning (docs/conventions.md): H_j = exp(share * log(H)).
class RelativeMotion {
 public:
  explicit RelativeMotion(const SE3& H);
  Eigen::Vector3d move(const ShapedPoint& point) const;
  /// d(moved point) / d xi, to the second order in log(H).
  Matrix36 jacobian(const ShapedPoint& point, const Eigen::Vector3d& moved) const;

 private:
  Eigen::Matrix3d rotation_;
  Eigen::Vector3d translation_;
  SE3::Tangent xi_;                      ///< log(H)
  Eigen::Matrix<double, 6, 6> bracket_;  ///< ad(log(H))
};

/// Eq. (6): mean of the voxel less the moved point.
VectorResidual point_residual(const ShapedPoint& point, const Eigen::Vector3d& voxel_mean,
                              const RelativeMotion& motion);

/// Eq. (7), with the sum: C_voxel + R_j C_point R_j^T.
Eigen::Matrix3d point_covariance(const ShapedPoint& point, const ObjectTarget::Voxel& voxel, const SE3& H);

}  // namespace mlo
