#include "mlo/detection/network_detector.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "mlo/detection/network_input.hpp"
#include "mlo/detection/suppression.hpp"
#include "mlo/network/box_code.hpp"

namespace mlo {
namespace {

constexpr double kMaxTilt_deg = 8.0;
constexpr double kMaxRingRatio = 1.6;
constexpr float kMaxIntensity = 1.5F;

std::size_t count_rings(std::span<const Point> points) {
  std::set<std::uint16_t> rings;
  for (const Point& point : points) {
    if (point.ring != Point::kNoRing) rings.insert(point.ring);
  }
  return rings.size();
}

}  // namespace

std::vector<Detection> detect_in_network_frame(std::span<const Point> points, const Network& network,
                                               const NetworkConfig& config) {
  if (points.empty()) return {};
  const NetworkArchitecture& architecture = network.architecture();
  const NetworkOutput output = network(network_input(points, architecture.input));
  return suppress_overlapping(decode_boxes(output, architecture, config.min_candidate), config.max_shared);
}

std::vector<Detection> detect_with_network(std::span<const Point> points,
                                           std::span<const std::uint8_t> is_ground, const Network& network,
                                           const NetworkConfig& config) {
  const NetworkInputSpec& spec = network.architecture().input;
  const NetworkFrame frame(points, is_ground, spec);
  if (frame.empty()) return {};
  std::vector<Detection> found =
      detect_in_network_frame(network_points(points, is_ground, frame, spec), network, config);
  for (Detection& detection : found) {
    Eigen::Vector3d& center = detection.box.center_lidar_m;
    center.z() -= frame.shift_at(center.x(), center.y());
  }
  return found;
}

std::vector<std::string> find_mismatches(std::span<const Point> points, const Eigen::Vector3f& up_lidar,
                                         const NetworkArchitecture& architecture) {
  const NetworkInputSpec& spec = architecture.input;
  std::vector<std::string> problems;
  const double tilt_deg =
      std::acos(std::clamp(static_cast<double>(up_lidar.z()), -1.0, 1.0)) * 180.0 / std::numbers::pi;
  if (tilt_deg > kMaxTilt_deg) {
    problems.push_back(fmt::format(
        "the ground is tilted by {:.0f} degrees against the lidar, but the network knows upright lidars "
        "only: level the scans, or train on such ones (mlo train)",
        tilt_deg));
  }
  const std::size_t rings = count_rings(points);
  const double ratio = static_cast<double>(rings) / std::max(spec.rings, 1);
  if (spec.rings > 0 && rings > 0 && std::max(ratio, 1.0 / ratio) > kMaxRingRatio) {
    problems.push_back(fmt::format(
        "the network was trained with a lidar of {} rings, this one has {}: expect it to find less, or "
        "train on scans of such a lidar (mlo simulate --preset, mlo train)",
        spec.rings, rings));
  }
  if (std::ranges::find(spec.features, PointFeature::intensity) != spec.features.end() && !points.empty()) {
    const auto [least, most] = std::ranges::minmax(points, {}, &Point::intensity);
    if (most.intensity > kMaxIntensity || least.intensity == most.intensity) {
      problems.push_back(fmt::format(
          "the network needs intensities from 0 to 1, but those of the scans are from {:g} to {:g}: scale "
          "them, or use weights that need none (detection.network.weights)",
          static_cast<double>(least.intensity), static_cast<double>(most.intensity)));
    }
  }
  return problems;
}

}  // namespace mlo
