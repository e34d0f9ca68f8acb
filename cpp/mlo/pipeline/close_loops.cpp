#include "mlo/pipeline/close_loops.hpp"

#include <algorithm>
#include <numbers>
#include <optional>

#include "mlo/core/voxel_grid.hpp"
#include "mlo/loops/loop_search.hpp"
#include "mlo/loops/pose_graph.hpp"
#include "mlo/mapping/place_search.hpp"

namespace mlo {
namespace {

// Keyframes to both sides of the earlier one that make up the map of its place.
constexpr std::size_t kMapKeyframes = 5;

// How well the estimate holds from keyframe to keyframe, and a registered loop: what counts is the ratio.
constexpr double kWaySd_m = 0.02;
constexpr double kWaySd_rad = 0.05 * std::numbers::pi / 180.0;
constexpr double kLoopSd_m = 0.02;
constexpr double kLoopSd_rad = 0.05 * std::numbers::pi / 180.0;

// The descriptor tells the heading to 6 degrees, and the place to a few metres.
constexpr double kSearch_m = 4.0;
constexpr double kSearch_deg = 6.0;

// What a scan saw of the environment, lidar frame.
std::vector<Eigen::Vector3f> environment(const SceneCloud& cloud) {
  std::vector<Eigen::Vector3f> points;
  for_each_point(cloud, [&](const ScenePoint& point, const PointGroup& group) {
    if (group.label != MapLabel::object) points.push_back(point.p);
  });
  return points;
}

std::vector<Keyframe> select_keyframes(const SceneFile& scene, double spacing_m) {
  std::vector<Keyframe> keyframes;
  double way_m = 0.0;
  std::optional<Eigen::Vector3d> last;
  for (std::size_t i = 0; i < scene.num_scans(); ++i) {
    const SceneScan scan = scene.scan(i);
    const Eigen::Vector3d& position = scan.T_map_lidar.translation();
    if (last) way_m += (position - *last).norm();
    last = position;
    const bool is_far = keyframes.empty() || way_m - keyframes.back().way_m >= spacing_m;
    const bool is_placed = scan.status == ScanStatus::first || scan.status == ScanStatus::localised;
    if (!is_far || !is_placed) continue;
    keyframes.push_back({.scan = i,
                         .way_m = way_m,
                         .T_map_lidar = scan.T_map_lidar,
                         .place = PlaceDescriptor(environment(scene.cloud(i)))});
  }
  return keyframes;
}

LocalMap map_around(const SceneFile& scene, std::span<const Keyframe> keyframes, std::size_t center,
                    const LocalMapConfig& config) {
  LocalMap map(config);
  const std::size_t begin = center - std::min(center, kMapKeyframes);
  const std::size_t end = std::min(keyframes.size(), center + kMapKeyframes + 1);
  for (const Keyframe& keyframe : keyframes.subspan(begin, end - begin)) {
    std::vector<Eigen::Vector3f> points_map = environment(scene.cloud(keyframe.scan));
    for (Eigen::Vector3f& p : points_map) p = (keyframe.T_map_lidar * p.cast<double>()).cast<float>();
    map.insert(points_map);
  }
  return map;
}

std::optional<Loop> register_loop(const SceneFile& scene, std::span<const Keyframe> keyframes,
                                  const LoopCandidate& candidate, const PipelineConfig& config) {
  const LocalMap map = map_around(scene, keyframes, candidate.earlier, config.mapping.local_map);
  std::vector<FeaturePoint> points;
  for (const Eigen::Vector3f& p : environment(scene.cloud(keyframes[candidate.later].scan))) {
    points.push_back({.p_lidar = p});
  }
  const RefinementTerm term{points, &map, ExpectedShape::plane};
  PlaceSearchConfig search = config.mapping.place_search;
  search.radius_m = kSearch_m;
  search.yaw_deg = kSearch_deg;
  search.min_share = config.loop_closure.min_share;
  const SE3& T_map_earlier = keyframes[candidate.earlier].T_map_lidar;
  const SE3 turn(so3_exp({0.0, 0.0, candidate.yaw_rad}), Eigen::Vector3d::Zero());
  // Where the estimate has it, as long as the drift is small; or where the place is that looks like it.
  for (const SE3& T_map_guess : {keyframes[candidate.later].T_map_lidar, T_map_earlier * turn}) {
    const PoseEstimate found = find_place({&term, 1}, T_map_guess, search, config.mapping.refinement);
    if (!found.usable() || found.degenerate_directions > 0) continue;
    return Loop{.earlier = candidate.earlier,
                .later = candidate.later,
                .T_earlier_later = T_map_earlier.inverse() * found.T_target_source};
  }
  return std::nullopt;
}

std::vector<SE3> fit(std::span<const Keyframe> keyframes, std::span<const Loop> loops) {
  std::vector<SE3> poses;
  std::vector<PoseGraphEdge> edges;
  for (const Keyframe& keyframe : keyframes) {
    if (!poses.empty()) {
      edges.push_back({.from = poses.size() - 1,
                       .to = poses.size(),
                       .T_from_to = poses.back().inverse() * keyframe.T_map_lidar,
                       .sd_m = kWaySd_m,
                       .sd_rad = kWaySd_rad});
    }
    poses.push_back(keyframe.T_map_lidar);
  }
  for (const Loop& loop : loops) {
    edges.push_back({.from = loop.earlier,
                     .to = loop.later,
                     .T_from_to = loop.T_earlier_later,
                     .sd_m = kLoopSd_m,
                     .sd_rad = kLoopSd_rad});
  }
  return optimize_pose_graph(std::move(poses), edges);
}

// Between two keyframes, a scan is moved by a part of what they are moved by.
std::vector<SE3> corrections_of_scans(std::span<const Keyframe> keyframes, std::span<const SE3> fitted,
                                      std::size_t num_scans) {
  std::vector<SE3> corrections(num_scans, fitted.back() * keyframes.back().T_map_lidar.inverse());
  for (std::size_t k = 0; k + 1 < keyframes.size(); ++k) {
    const SE3 begin = fitted[k] * keyframes[k].T_map_lidar.inverse();
    const SE3 end = fitted[k + 1] * keyframes[k + 1].T_map_lidar.inverse();
    const std::size_t count = keyframes[k + 1].scan - keyframes[k].scan;
    for (std::size_t i = 0; i < count; ++i) {
      const double share = static_cast<double>(i) / static_cast<double>(count);
      corrections[keyframes[k].scan + i] = interpolate(end * begin.inverse(), share) * begin;
    }
  }
  return corrections;
}

}  // namespace

ClosedLoops close_loops(const SceneFile& scene, const PipelineConfig& config) {
  ClosedLoops closed;
  const std::vector<Keyframe> keyframes = select_keyframes(scene, config.loop_closure.keyframe_m);
  const std::vector<LoopCandidate> candidates = find_loop_candidates(keyframes, config.loop_closure);
  closed.candidates = candidates.size();
  std::vector<Loop> registered;
  for (const LoopCandidate& candidate : candidates) {
    const std::optional<Loop> loop = register_loop(scene, keyframes, candidate, config);
    if (loop) registered.push_back(*loop);
  }
  const std::vector<Loop> loops = agreeing_loops(registered, keyframes);
  closed.loops = loops.size();
  if (!loops.empty()) {
    closed.corrections = corrections_of_scans(keyframes, fit(keyframes, loops), scene.num_scans());
  }
  return closed;
}

}  // namespace mlo
