#include "mlo/evaluation/map_removal.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vector>

#include <tsl/robin_map.h>

#include "mlo/core/parallel.hpp"
#include "mlo/core/voxel_grid.hpp"
#include "mlo/evaluation/point_tree.hpp"

namespace mlo {
namespace {

constexpr double kHalfDiagonal = 0.5 * std::numbers::sqrt3;  // of a cube of side 1

std::optional<double> share(std::size_t part, std::size_t whole) {
  if (whole == 0) return std::nullopt;
  return static_cast<double>(part) / static_cast<double>(whole);
}

struct KeptPoints {
  std::size_t at_rest = 0;
  std::size_t moving = 0;
  KeptPoints& operator+=(const KeptPoints& other) {
    at_rest += other.at_rest;
    moving += other.moving;
    return *this;
  }
};

KeptPoints kept_points(std::span<const LabelledPoint> truth, const PointCloud& map, double distance_m) {
  if (map.points.empty()) return {};
  const PointTree tree(3, map);
  const auto largest_squared = static_cast<float>(distance_m * distance_m);
  return parallel_sum<KeptPoints>(truth.size(), [&](KeptPoints& kept, std::size_t i) {
    std::size_t nearest = 0;
    float distance_squared = 0.0F;
    tree.knnSearch(truth[i].p_map.data(), 1, &nearest, &distance_squared);
    if (distance_squared > largest_squared) return;
    ++(truth[i].mobility == Mobility::moving ? kept.moving : kept.at_rest);
  });
}

std::size_t count_moving(std::span<const LabelledPoint> points) {
  return static_cast<std::size_t>(std::count_if(
      points.begin(), points.end(), [](const auto& point) { return point.mobility == Mobility::moving; }));
}

// What the points of one voxel have in common.
struct VoxelSum {
  Eigen::Vector3f position = Eigen::Vector3f::Zero();
  long points = 0;
  long at_rest = 0;  // less those that move
};

// Each voxel as one point: the mean of its points, moving if most of them are.
std::vector<LabelledPoint> voxelise(std::span<const LabelledPoint> truth, double voxel_m) {
  const auto inverse_size = static_cast<float>(1.0 / voxel_m);
  tsl::robin_map<VoxelKey, VoxelSum, VoxelKeyHash> voxels;
  for (const LabelledPoint& point : truth) {
    VoxelSum& sum = voxels[voxel_key(point.p_map, inverse_size)];
    sum.position += point.p_map;
    ++sum.points;
    sum.at_rest += point.mobility == Mobility::moving ? -1 : 1;
  }
  std::vector<LabelledPoint> middles;
  middles.reserve(voxels.size());
  for (const auto& [key, sum] : voxels) {
    middles.push_back({sum.position / static_cast<float>(sum.points),
                       sum.at_rest < 0 ? Mobility::moving : Mobility::at_rest});
  }
  return middles;
}

}  // namespace

std::optional<double> MapRemoval::preservation_rate() const {
  return share(static_voxels_kept, static_voxels);
}

std::optional<double> MapRemoval::rejection_rate() const {
  return share(dynamic_voxels - dynamic_voxels_kept, dynamic_voxels);
}

std::optional<double> MapRemoval::f1() const {
  const std::optional<double> preserved = preservation_rate();
  const std::optional<double> rejected = rejection_rate();
  if (!preserved || !rejected) return std::nullopt;
  const double sum = *preserved + *rejected;
  return sum > 0.0 ? 2.0 * *preserved * *rejected / sum : 0.0;
}

std::optional<double> MapRemoval::static_accuracy() const {
  return share(static_points_kept, static_points);
}

std::optional<double> MapRemoval::dynamic_accuracy() const {
  return share(dynamic_points - dynamic_points_kept, dynamic_points);
}

std::optional<double> MapRemoval::associated_accuracy() const {
  const std::optional<double> of_static = static_accuracy();
  const std::optional<double> of_dynamic = dynamic_accuracy();
  if (!of_static || !of_dynamic) return std::nullopt;
  return std::sqrt(*of_static * *of_dynamic);
}

MapRemoval map_removal(std::span<const LabelledPoint> truth, std::span<const Eigen::Vector3f> map,
                       const MapRemovalOptions& options) {
  std::vector<LabelledPoint> counted;
  std::copy_if(truth.begin(), truth.end(), std::back_inserter(counted), [](const LabelledPoint& point) {
    return point.mobility != Mobility::unknown && point.p_map.allFinite();
  });
  PointCloud cloud;
  std::copy_if(map.begin(), map.end(), std::back_inserter(cloud.points),
               [](const Eigen::Vector3f& point) { return point.allFinite(); });

  MapRemoval result;
  result.dynamic_points = count_moving(counted);
  result.static_points = counted.size() - result.dynamic_points;
  const KeptPoints kept = kept_points(counted, cloud, options.distance_m);
  result.static_points_kept = kept.at_rest;
  result.dynamic_points_kept = kept.moving;

  const std::vector<LabelledPoint> voxels = voxelise(counted, options.voxel_m);
  result.dynamic_voxels = count_moving(voxels);
  result.static_voxels = voxels.size() - result.dynamic_voxels;
  const KeptPoints kept_voxels = kept_points(voxels, cloud, kHalfDiagonal * options.voxel_m);
  result.static_voxels_kept = kept_voxels.at_rest;
  result.dynamic_voxels_kept = kept_voxels.moving;
  return result;
}

}  // namespace mlo
