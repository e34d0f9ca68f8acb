#include "mlo/detection/consistency.hpp"

#include <algorithm>
#include <optional>

#include "mlo/core/log_odds.hpp"

namespace mlo {
namespace {

// However long something was seen, it can become doubtful within a few scans.
constexpr double kMaxRemembered = 4.0;

/// Log-odds of the nearest one of the class within the distance, seen from above.
std::optional<double> nearest_before(const Detection& detection, std::span<const Detection> before,
                                     std::span<const Eigen::Vector3d> centers_now, double within_m) {
  std::optional<double> found;
  double nearest_m = within_m;
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (before[i].object_class != detection.object_class) continue;
    const double distance_m = (centers_now[i] - detection.box.center_lidar_m).head<2>().norm();
    if (!(distance_m < nearest_m)) continue;
    nearest_m = distance_m;
    found = log_odds(before[i].confidence);
  }
  return found;
}

}  // namespace

std::vector<Detection> weigh_by_previous(std::vector<Detection> now, std::span<const Detection> before,
                                         const SE3& T_now_before, const RecurrenceConfig& config) {
  std::vector<Eigen::Vector3d> centers_now;
  for (const Detection& detection : before)
    centers_now.push_back(T_now_before * detection.box.center_lidar_m);
  for (Detection& detection : now) {
    const auto earlier = nearest_before(detection, before, centers_now, config.within_m);
    const double gained =
        earlier ? config.share * std::clamp(*earlier, -kMaxRemembered, kMaxRemembered) : -config.new_loses;
    detection.confidence = probability(log_odds(detection.confidence) + gained);
  }
  return now;
}

}  // namespace mlo
