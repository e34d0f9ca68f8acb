#pragma once

#include <span>

#include <Eigen/Core>

namespace mlo {

/// What a place looks like from above, whatever the heading: the highest point in each of 20 rings by 60
/// sectors around the lidar (Scan Context: Kim and Kim, IROS 2018).
class PlaceDescriptor {
 public:
  PlaceDescriptor() = default;
  /// @param points_lidar  [m]; those beyond 80 m or not finite are left out
  explicit PlaceDescriptor(std::span<const Eigen::Vector3f> points_lidar);

  static constexpr int kRings = 20;
  static constexpr int kSectors = 60;
  /// Above 2 m below the lidar [m], a column for each sector; 0 where nothing is.
  const Eigen::Matrix<float, kRings, kSectors>& heights_m() const { return heights_m_; }

 private:
  Eigen::Matrix<float, kRings, kSectors> heights_m_ = Eigen::Matrix<float, kRings, kSectors>::Zero();
};

/// How little two places are alike.
struct PlaceDifference {
  double value = 1.0;    ///< 0 for equal descriptors, 1 when they have nothing in common
  double yaw_rad = 0.0;  ///< heading of the second in the frame of the first, to 6 degrees
};
PlaceDifference compare(const PlaceDescriptor& first, const PlaceDescriptor& second);

}  // namespace mlo
