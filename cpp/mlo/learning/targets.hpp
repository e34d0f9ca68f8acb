#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/point_operations.hpp"

namespace mlo {

/// A true box in the frame of the network.
struct TargetBox {
  static constexpr int kIgnored = -1;  ///< of no class that the network knows, or seen by too few points

  Box3d box;
  int class_index = kIgnored;
};

/// What the network should say of each of its candidates.
struct CandidateTargets {
  static constexpr std::int64_t kBackground = -1;
  static constexpr std::int64_t kIgnored = -2;  ///< whatever it says is right

  std::vector<std::int64_t> class_index;  ///< of a class, or one of the two above
  std::vector<float> centerness;          ///< how near to the middle of its box a candidate lies, in [0, 1]
  RowMatrix codes;                        ///< six numbers each (encode_box); zero where there is no class
  std::vector<std::int64_t> angle_bin;
  std::vector<float> angle_residual;
  RowMatrix corners;  ///< true boxes: center (3), size (3), yaw; zero where there is no class
  /// Of the points that the candidates began as: where they are on an object, the way to its middle.
  std::vector<std::uint8_t> is_on_object;
  PointRows shifts;
};

/// Centre-ness of a point in a box (3DSSD, Eq. 3 and 4, after FCOS): cube root of the product over the axes
/// of the distance to the nearer face over that to the farther one; 1 in the middle, 0 on a face and outside.
double centerness(const Box3d& box, const Eigen::Vector3d& point);

/// A candidate that lies in a true box is of its class; one that lies just outside is ignored, and so is what
/// lies in a box that is ignored.
/// @param origins     the points that the candidates began as, one row each
/// @param candidates  the same after their shifts
CandidateTargets assign_targets(const PointRows& origins, const PointRows& candidates,
                                std::span<const TargetBox> boxes, const NetworkArchitecture& architecture);

}  // namespace mlo
