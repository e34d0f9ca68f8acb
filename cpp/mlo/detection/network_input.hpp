#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"
#include "mlo/detection/ground_heights.hpp"
#include "mlo/network/architecture.hpp"
#include "mlo/network/network.hpp"

namespace mlo {

/// Networks see scans in a frame that does not depend on where the lidar is mounted: x and y as in the lidar
/// frame, z from the ground (NetworkInputSpec::sensor_height_m below the lidar's origin).
class NetworkFrame {
 public:
  /// @param is_ground  per point: 1 ground, 0 not
  NetworkFrame(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
               const NetworkInputSpec& spec)
      : ground_(points, is_ground, spec.max_range_m), sensor_height_m_(spec.sensor_height_m) {}

  /// True if no ground was seen: then the frame is not known.
  bool empty() const { return ground_.empty(); }
  /// What is added to z on the way from the lidar frame to that of the network.
  double shift_at(double x_m, double y_m) const {
    return -static_cast<double>(ground_.interpolated_at({static_cast<float>(x_m), static_cast<float>(y_m)})) -
           sensor_height_m_;
  }

 private:
  GroundHeights ground_;
  double sensor_height_m_;
};

/// The points that a network takes in, in its frame: those within its range, heights and angles, thinned to
/// its budget, in an order that looks random, so that the first of any region are spread over it.
/// @param points  finite
std::vector<Point> network_points(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                                  const NetworkFrame& frame, const NetworkInputSpec& spec);

/// @param points  in the network's frame
NetworkInput network_input(std::span<const Point> points, const NetworkInputSpec& spec);

}  // namespace mlo
