#include "mlo/perception/scan_lines.hpp"

#include <algorithm>
#include <cmath>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

/// Neighbours on each side that smoothness looks at, as in LOAM.
constexpr std::size_t kNeighbours = 5;

/// One line's coordinates side by side, so that the sums run over whole registers.
struct LineCoordinates {
  std::vector<float> x, y, z, range;

  LineCoordinates(std::span<const Point> points, std::span<const std::uint32_t> line) {
    for (std::vector<float>* values : {&x, &y, &z, &range}) values->resize(line.size());
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Eigen::Vector3f& p = points[line[i]].p_lidar;
      x[i] = p.x();
      y[i] = p.y();
      z[i] = p.z();
      range[i] = p.norm();
    }
  }
  std::size_t size() const { return x.size(); }
  Eigen::Vector3f at(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

std::size_t num_neighbours(std::size_t i, std::size_t size) {
  return std::min(i, kNeighbours) + std::min(size - 1 - i, kNeighbours);
}

/// Sum of the neighbours' values within the line minus the value itself as often.
std::vector<float> neighbour_differences(const std::vector<float>& values) {
  const std::size_t n = values.size();
  std::vector<float> sums(n, 0.0F);
  for (std::size_t k = 1; k <= kNeighbours; ++k) {
    for (std::size_t i = 0; i + k < n; ++i) sums[i] += values[i + k] - values[i];
    for (std::size_t i = k; i < n; ++i) sums[i] += values[i - k] - values[i];
  }
  return sums;
}

std::vector<float> smoothness_of(const LineCoordinates& line) {
  const std::vector<float> dx = neighbour_differences(line.x);
  const std::vector<float> dy = neighbour_differences(line.y);
  const std::vector<float> dz = neighbour_differences(line.z);
  std::vector<float> smoothness(line.size(), 0.0F);
  for (std::size_t i = 0; i < line.size(); ++i) {
    const float divisor = static_cast<float>(num_neighbours(i, line.size())) * line.range[i];
    const float length = std::sqrt(dx[i] * dx[i] + dy[i] * dy[i] + dz[i] * dz[i]);
    smoothness[i] = divisor > 0.0F ? length / divisor : 0.0F;
  }
  return smoothness;
}

/// Between neighbours i and i+1 that are close in angle but not in range, the farther surface goes on behind
/// the nearer one: its border moves with the sensor. LOAM's Fig. 4(b).
void exclude_hidden_borders(const LineCoordinates& line, std::span<std::uint8_t> reliable) {
  constexpr float kMinSquaredJump = 0.1F;  // [m^2]
  constexpr float kMaxAngle = 0.1F;        // as chord [rad]
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const Eigen::Vector3f a = line.at(i);
    const Eigen::Vector3f b = line.at(i + 1);
    if ((a - b).squaredNorm() <= kMinSquaredJump) continue;
    const float nearer = std::min(line.range[i], line.range[i + 1]);
    const float farther = std::max(line.range[i], line.range[i + 1]);
    if (nearer <= 0.0F) continue;
    const Eigen::Vector3f chord = a / line.range[i] - b / line.range[i + 1];
    if (farther == nearer || chord.norm() >= kMaxAngle) continue;
    const bool a_is_farther = line.range[i] > line.range[i + 1];
    const std::size_t first = a_is_farther ? i - std::min(i, kNeighbours) : i + 1;
    const std::size_t last = a_is_farther ? i : std::min(i + 1 + kNeighbours, line.size() - 1);
    std::fill(reliable.begin() + static_cast<std::ptrdiff_t>(first),
              reliable.begin() + static_cast<std::ptrdiff_t>(last + 1), std::uint8_t{0});
  }
}

/// Points far from both neighbours for their range lie on a surface almost parallel to the beam. LOAM's
/// Fig. 4(a).
void exclude_grazed_surfaces(const LineCoordinates& line, std::span<std::uint8_t> reliable) {
  constexpr float kMaxSpacing = 0.0002F;  // squared distance to a neighbour over squared range
  for (std::size_t i = 1; i + 1 < line.size(); ++i) {
    const float limit = kMaxSpacing * line.range[i] * line.range[i];
    const Eigen::Vector3f p = line.at(i);
    if ((line.at(i - 1) - p).squaredNorm() > limit && (line.at(i + 1) - p).squaredNorm() > limit)
      reliable[i] = 0;
  }
}

std::vector<std::uint8_t> reliable_of(const LineCoordinates& line) {
  std::vector<std::uint8_t> reliable(line.size(), 0);
  for (std::size_t i = kNeighbours; i + kNeighbours < line.size(); ++i)
    reliable[i] = line.range[i] > 0.0F ? 1 : 0;
  exclude_hidden_borders(line, reliable);
  exclude_grazed_surfaces(line, reliable);
  return reliable;
}

/// Appends the runs of points whose mark is `kind` among the places [first, last).
void append_runs(const ScanLines& lines, std::span<const std::uint8_t> is_ground, std::uint8_t kind,
                 std::size_t first, std::size_t last, std::vector<PointRun>& runs) {
  bool inside = false;
  for (std::size_t place = first; place < last; ++place) {
    const bool matches = is_ground[lines.order[place]] == kind;
    if (matches && !inside)
      runs.push_back({static_cast<std::uint32_t>(place), static_cast<std::uint32_t>(place)});
    if (matches) runs.back().tail = static_cast<std::uint32_t>(place);
    inside = matches;
  }
}

SegmentRuns list_runs(const ScanLines& lines, std::span<const std::uint8_t> is_ground, std::uint8_t kind,
                      std::size_t segments_per_line) {
  std::vector<std::vector<PointRun>> by_segment(lines.num_lines() * segments_per_line);
  parallel_for_each_index(by_segment.size(), [&](std::size_t segment) {
    const std::size_t line = segment / segments_per_line;
    const std::size_t part = segment % segments_per_line;
    const std::size_t size = lines.begin[line + 1] - lines.begin[line];
    append_runs(lines, is_ground, kind, lines.begin[line] + size * part / segments_per_line,
                lines.begin[line] + size * (part + 1) / segments_per_line, by_segment[segment]);
  });
  SegmentRuns all;
  all.begin.push_back(0);
  for (const std::vector<PointRun>& runs : by_segment) {
    all.runs.insert(all.runs.end(), runs.begin(), runs.end());
    all.begin.push_back(all.runs.size());
  }
  return all;
}

}  // namespace

ScanLines group_lines(std::span<const Point> points) {
  std::vector<std::size_t> counts;
  for (const Point& point : points) {
    if (point.ring == Point::kNoRing) continue;
    if (point.ring >= counts.size()) counts.resize(point.ring + std::size_t{1}, 0);
    ++counts[point.ring];
  }
  ScanLines lines;
  lines.begin.assign(1, 0);
  for (const std::size_t count : counts) lines.begin.push_back(lines.begin.back() + count);
  lines.order.resize(lines.begin.back());
  std::vector<std::size_t> next(lines.begin.begin(), lines.begin.end() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (points[i].ring != Point::kNoRing) lines.order[next[points[i].ring]++] = static_cast<std::uint32_t>(i);
  }
  return lines;
}

LineShape measure_lines(std::span<const Point> points, const ScanLines& lines) {
  LineShape shape;
  shape.smoothness.assign(points.size(), 0.0F);
  shape.reliable.assign(points.size(), 0);
  parallel_for_each_index(lines.num_lines(), [&](std::size_t line_number) {
    const std::size_t first = lines.begin[line_number];
    const std::size_t size = lines.begin[line_number + 1] - first;
    const std::span<const std::uint32_t> members =
        std::span<const std::uint32_t>(lines.order).subspan(first, size);
    const LineCoordinates line(points, members);
    const std::vector<float> smoothness = smoothness_of(line);
    const std::vector<std::uint8_t> reliable = reliable_of(line);
    for (std::size_t i = 0; i < size; ++i) {
      shape.smoothness[members[i]] = smoothness[i];
      shape.reliable[members[i]] = reliable[i];
    }
  });
  return shape;
}

SegmentedLines segment_lines(const ScanLines& lines, std::span<const std::uint8_t> is_ground,
                             int segments_per_line) {
  const auto segments = static_cast<std::size_t>(segments_per_line);
  return {list_runs(lines, is_ground, 1, segments), list_runs(lines, is_ground, 0, segments)};
}

}  // namespace mlo
