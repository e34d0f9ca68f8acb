#include "mlo/perception/perceive.hpp"

#include <algorithm>

#include "mlo/core/parallel.hpp"
#include "mlo/perception/features.hpp"
#include "mlo/perception/fusion.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/perception/objects.hpp"
#include "mlo/perception/scan_lines.hpp"

namespace mlo {
namespace {

std::size_t count_of(std::span<const PointKind> kinds, PointKind kind) {
  return static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), kind));
}

/// A feature set whose candidates are the points of a kind, `taken` left out.
FeatureSet gather_set(PointKind kind, std::span<const std::uint32_t> features,
                      std::span<const std::uint32_t> taken, std::span<const Point> points,
                      const LineShape& shape, std::span<const PointKind> kinds, const FeatureConfig& config) {
  FeatureSet set;
  set.features = gather_features(points, shape, features);
  set.candidates = gather_candidates(points, shape, kinds, kind, taken, config.candidate_voxel_m);
  const std::vector<FeaturePoint> more = choose_without_lines(set.candidates, config.no_line_voxel_m);
  set.features.insert(set.features.end(), more.begin(), more.end());
  return set;
}

std::vector<ObjectPoints> gather_objects(std::span<const Point> points, std::span<const Detection> detections,
                                         std::span<const PointKind> kinds,
                                         std::span<const std::uint16_t> object_ids, const LineShape& shape,
                                         std::span<const std::uint32_t> object_edges) {
  std::vector<std::vector<Point>> members = collect_objects(points, kinds, object_ids, detections.size());
  std::vector<std::vector<std::uint32_t>> edges(detections.size());
  for (const std::uint32_t i : object_edges) edges[object_ids[i]].push_back(i);
  std::vector<ObjectPoints> objects;
  objects.reserve(detections.size());
  for (std::size_t k = 0; k < detections.size(); ++k) {
    objects.push_back({detections[k], std::move(members[k]), gather_features(points, shape, edges[k])});
  }
  return objects;
}

}  // namespace

Percept perceive(const Scan& scan, std::span<const Detection> detections, const PerceptionConfig& config) {
  return perceive(scan, segment_ground(scan.points, config.ground), detections, config);
}

Percept perceive(const Scan& scan, const GroundSegmentation& ground, std::span<const Detection> detections,
                 const PerceptionConfig& config) {
  const std::span<const Point> points(scan.points);
  std::vector<std::uint16_t> object_ids;
  ScanLines lines;
  LineShape shape;
  parallel_invoke([&] { object_ids = label_objects(points, detections, config.fusion.box_margin_m); },
                  [&] {
                    lines = group_lines(points);
                    shape = measure_lines(points, lines);
                  });
  const std::vector<PointKind> kinds = correct_mutually(ground.is_ground, object_ids);
  const SegmentedLines segments = segment_lines(lines, ground.is_ground, config.features.segments_per_line);
  const ChosenPoints chosen = choose_points(lines, shape, segments, kinds, config.features);

  Percept percept;
  parallel_invoke(
      [&] {
        percept.ground =
            gather_set(PointKind::ground, chosen.ground, {}, points, shape, kinds, config.features);
      },
      [&] {
        percept.surface = gather_set(PointKind::background, chosen.surfaces, chosen.edge_candidates, points,
                                     shape, kinds, config.features);
      });
  percept.edge.features = gather_features(points, shape, chosen.edges);
  percept.edge.candidates = gather_features(points, shape, chosen.edge_candidates);
  percept.objects = gather_objects(points, detections, kinds, object_ids, shape, chosen.object_edges);
  percept.mean_ground_smoothness = mean_smoothness(percept.ground.features);
  percept.num_ground_points = count_of(kinds, PointKind::ground);
  percept.num_ambiguous_points = count_of(kinds, PointKind::ambiguous);
  return percept;
}

}  // namespace mlo
