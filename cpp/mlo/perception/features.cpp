#include "mlo/perception/features.hpp"

#include <algorithm>
#include <limits>

#include "mlo/core/parallel.hpp"
#include "mlo/core/voxel_grid.hpp"

namespace mlo {
namespace {

/// A chosen point keeps as many neighbours on each side from being chosen, as in LOAM.
constexpr std::size_t kSuppressed = 5;

enum class Wanted { flattest, sharpest };

/// Chooses points of one scan line, segment by segment.
class LineChooser {
 public:
  LineChooser(const ScanLines& lines, std::size_t line, const LineShape& shape)
      : order_(lines.order), first_(lines.begin[line]), last_(lines.begin[line + 1]), shape_(shape) {
    free_.reserve(last_ - first_);
    for (std::size_t place = first_; place < last_; ++place) free_.push_back(shape.reliable[order_[place]]);
  }

  /// Appends to `chosen` the best `count` of the places that are still free.
  void choose(std::vector<std::uint32_t> places, Wanted wanted, std::size_t count,
              std::vector<std::uint32_t>& chosen) {
    const auto is_worse = [&](std::uint32_t a, std::uint32_t b) {
      const float ca = shape_.smoothness[order_[a]];
      const float cb = shape_.smoothness[order_[b]];
      if (ca != cb) return wanted == Wanted::sharpest ? ca < cb : ca > cb;
      return a > b;
    };
    std::make_heap(places.begin(), places.end(), is_worse);  // cheaper than sorting: few of many are wanted
    for (auto end = places.end(); end != places.begin() && count > 0; --end) {
      const std::uint32_t best = places.front();
      std::pop_heap(places.begin(), end, is_worse);
      if (free_[best - first_] == 0) continue;
      chosen.push_back(order_[best]);
      suppress_around(best);
      --count;
    }
  }

 private:
  void suppress_around(std::size_t place) {
    const std::size_t at = place - first_;
    const std::size_t begin = at - std::min(at, kSuppressed);
    const std::size_t end = std::min(at + kSuppressed + 1, free_.size());
    std::fill(free_.begin() + static_cast<std::ptrdiff_t>(begin),
              free_.begin() + static_cast<std::ptrdiff_t>(end), std::uint8_t{0});
  }

  const std::vector<std::uint32_t>& order_;
  std::size_t first_;
  std::size_t last_;
  const LineShape& shape_;
  std::vector<std::uint8_t> free_;  ///< per point of the line: may still be chosen
};

/// Everything that choosing looks at.
struct Inputs {
  const ScanLines& lines;
  const LineShape& shape;
  const SegmentedLines& segments;
  std::span<const PointKind> kinds;
  const FeatureConfig& config;

  /// Reliable places of one kind in the runs whose smoothness lies within the limits.
  std::vector<std::uint32_t> places(std::span<const PointRun> runs, PointKind kind, double min_smoothness,
                                    double max_smoothness) const {
    std::vector<std::uint32_t> found;
    for (const PointRun& run : runs) {
      for (std::uint32_t place = run.head; place <= run.tail; ++place) {
        const std::uint32_t i = lines.order[place];
        const double c = shape.smoothness[i];
        if (shape.reliable[i] != 0 && kinds[i] == kind && c >= min_smoothness && c <= max_smoothness) {
          found.push_back(place);
        }
      }
    }
    return found;
  }
};

constexpr double kAny = std::numeric_limits<double>::infinity();

/// `from`: the runs of one segment of V_b.
void choose_background(const Inputs& in, std::span<const PointRun> from, LineChooser& chooser,
                       ChosenPoints& chosen) {
  const FeatureConfig& config = in.config;
  const std::size_t before = chosen.edge_candidates.size();
  chooser.choose(in.places(from, PointKind::background, config.min_edge_smoothness, kAny), Wanted::sharpest,
                 static_cast<std::size_t>(config.edge_candidates_per_segment), chosen.edge_candidates);
  const std::size_t edges =
      std::min(chosen.edge_candidates.size() - before, static_cast<std::size_t>(config.edges_per_segment));
  const auto sharpest = chosen.edge_candidates.begin() + static_cast<std::ptrdiff_t>(before);
  chosen.edges.insert(chosen.edges.end(), sharpest, sharpest + static_cast<std::ptrdiff_t>(edges));
  chooser.choose(in.places(from, PointKind::background, 0.0, config.max_surface_smoothness), Wanted::flattest,
                 static_cast<std::size_t>(config.surfaces_per_segment), chosen.surfaces);
}

ChosenPoints choose_on_line(const Inputs& in, std::size_t line) {
  ChosenPoints chosen;
  LineChooser ground(in.lines, line, in.shape);
  LineChooser background(in.lines, line, in.shape);
  LineChooser objects(in.lines, line, in.shape);
  const auto per_line = static_cast<std::size_t>(in.config.segments_per_line);
  for (std::size_t segment = line * per_line; segment < (line + 1) * per_line; ++segment) {
    ground.choose(in.places(in.segments.ground.segment(segment), PointKind::ground, 0.0, kAny),
                  Wanted::flattest, static_cast<std::size_t>(in.config.ground_per_segment), chosen.ground);
    const std::span<const PointRun> from = in.segments.background.segment(segment);
    choose_background(in, from, background, chosen);
    objects.choose(in.places(from, PointKind::object, in.config.min_edge_smoothness, kAny), Wanted::sharpest,
                   static_cast<std::size_t>(in.config.edge_candidates_per_segment), chosen.object_edges);
  }
  return chosen;
}

void append(std::vector<std::uint32_t>& to, const std::vector<std::uint32_t>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

FeaturePoint to_feature(const Point& point, float smoothness) {
  return {point.p_lidar, point.sweep_fraction, smoothness, point.intensity, point.ring};
}

}  // namespace

ChosenPoints choose_points(const ScanLines& lines, const LineShape& shape, const SegmentedLines& segments,
                           std::span<const PointKind> kinds, const FeatureConfig& config) {
  const Inputs inputs{lines, shape, segments, kinds, config};
  std::vector<ChosenPoints> by_line(lines.num_lines());
  parallel_for_each_index(by_line.size(),
                          [&](std::size_t line) { by_line[line] = choose_on_line(inputs, line); });
  ChosenPoints all;
  for (const ChosenPoints& line : by_line) {
    append(all.ground, line.ground);
    append(all.edges, line.edges);
    append(all.edge_candidates, line.edge_candidates);
    append(all.surfaces, line.surfaces);
    append(all.object_edges, line.object_edges);
  }
  return all;
}

std::vector<FeaturePoint> gather_features(std::span<const Point> points, const LineShape& shape,
                                          std::span<const std::uint32_t> indices) {
  std::vector<FeaturePoint> features;
  features.reserve(indices.size());
  for (const std::uint32_t i : indices) features.push_back(to_feature(points[i], shape.smoothness[i]));
  return features;
}

std::vector<FeaturePoint> gather_candidates(std::span<const Point> points, const LineShape& shape,
                                            std::span<const PointKind> kinds, PointKind kind,
                                            std::span<const std::uint32_t> excluded, double voxel_m) {
  std::vector<std::uint8_t> wanted(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) wanted[i] = kinds[i] == kind ? 1 : 0;
  for (const std::uint32_t i : excluded) wanted[i] = 0;
  std::vector<std::uint32_t> indices;
  indices.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (wanted[i] != 0) indices.push_back(static_cast<std::uint32_t>(i));
  }
  const std::vector<std::uint32_t> kept =
      downsample_first(std::span<const std::uint32_t>(indices), static_cast<float>(voxel_m),
                       [&](std::uint32_t i) -> const Eigen::Vector3f& { return points[i].p_lidar; });
  return gather_features(points, shape, kept);
}

std::vector<FeaturePoint> choose_without_lines(std::span<const FeaturePoint> candidates, double voxel_m) {
  std::vector<FeaturePoint> without_line;
  for (const FeaturePoint& candidate : candidates) {
    if (candidate.ring == Point::kNoRing) without_line.push_back(candidate);
  }
  return downsample_first(std::span<const FeaturePoint>(without_line), static_cast<float>(voxel_m),
                          [](const FeaturePoint& point) -> const Eigen::Vector3f& { return point.p_lidar; });
}

double mean_smoothness(std::span<const FeaturePoint> features) {
  double sum = 0.0;
  for (const FeaturePoint& feature : features) sum += feature.smoothness;
  return features.empty() ? 0.0 : sum / static_cast<double>(features.size());
}

}  // namespace mlo
