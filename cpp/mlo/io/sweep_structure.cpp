#include "mlo/io/sweep_structure.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>

#include <fmt/format.h>

#include "mlo/core/azimuth.hpp"

namespace mlo {
namespace {

constexpr double kRadToDeg = 180.0 / std::numbers::pi;

// Azimuth [turns] and slope (tangent of the elevation) of each point.
struct Angles {
  std::vector<float> azimuth;
  std::vector<float> slope;
};

Angles measure_angles(std::span<const Point> points) {
  constexpr float kAxisRadius = 1e-3F;  // nearer to the z axis there is no azimuth [m]
  Angles angles{std::vector<float>(points.size()), std::vector<float>(points.size())};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i].p_lidar;
    angles.azimuth[i] = azimuth_turns(p.x(), p.y());
    angles.slope[i] = p.z() / std::max(std::sqrt(p.x() * p.x() + p.y() * p.y()), kAxisRadius);
  }
  return angles;
}

// A difference of azimuths as the shortest way round, in [-0.5, 0.5).
float shortest(float turns) {
  return turns - std::floor(turns + 0.5F);
}

// +1 if the azimuth mostly grows from point to point, -1 if it mostly falls, 0 if neither: no scan lines.
int storage_direction(const std::vector<float>& azimuth) {
  constexpr double kClearMajority = 0.75;
  std::size_t growing = 0;
  std::size_t falling = 0;
  for (std::size_t i = 1; i < azimuth.size(); ++i) {
    const float step = shortest(azimuth[i] - azimuth[i - 1]);
    growing += step > 0.0F;
    falling += step < 0.0F;
  }
  const auto needed = kClearMajority * static_cast<double>(growing + falling);
  if (static_cast<double>(growing) > needed) return 1;
  return static_cast<double>(falling) > needed ? -1 : 0;
}

double mean(std::span<const float> values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

// Slope step from one line to the next, about: from the first to the last tenth of the points, per turn of
// azimuth.
double step_between_lines(const Angles& angles) {
  const std::size_t tenth = std::max<std::size_t>(1, angles.slope.size() / 10);
  const std::span<const float> slope = angles.slope;
  double turns = 0.0;
  for (std::size_t i = 1; i < slope.size(); ++i) turns += shortest(angles.azimuth[i] - angles.azimuth[i - 1]);
  return (mean(slope.last(tenth)) - mean(slope.first(tenth))) / std::max(1.0, 0.9 * std::abs(turns));
}

// The azimuth [turns] at which the lines are cut: somewhere from where the file ends on to where it begins,
// and there where most steps of slope are like those from line to line. A step across a gap votes for every
// azimuth in the gap, since the cut may be anywhere in it.
float find_cut(const Angles& angles, int direction) {
  constexpr int kBins = 14400;
  const auto sense = static_cast<float>(direction);
  const float file_end = angles.azimuth.back();
  const float begin_after_end = sense * (angles.azimuth.front() - file_end);
  const float width = begin_after_end - std::floor(begin_after_end);
  const double line_step = step_between_lines(angles);
  std::vector<int> votes(kBins, 0);
  const auto past_end = [&](float azimuth) {
    const float along = sense * (azimuth - file_end);
    return along - std::floor(along);
  };
  for (std::size_t i = 1; i < angles.azimuth.size(); ++i) {
    const float step_turns = sense * shortest(angles.azimuth[i] - angles.azimuth[i - 1]);
    const float from = past_end(angles.azimuth[i - 1]);
    if (step_turns < 0.0F || (from > width && from + step_turns < 1.0F)) continue;
    const double steps = (static_cast<double>(angles.slope[i]) - angles.slope[i - 1]) / line_step;
    const int vote = steps > 0.3 && steps < 3.0 ? 1 : 0;
    const auto last = static_cast<int>((from + step_turns) * kBins);
    for (int bin = static_cast<int>(from * kBins); bin <= last; ++bin)
      votes[static_cast<std::size_t>(bin % kBins)] += vote;
  }
  const auto past_width = votes.begin() + std::min(kBins, static_cast<int>(width * kBins) + 1);
  const auto peak = std::max_element(votes.begin(), past_width);
  const auto peak_end = std::find_if(peak, past_width, [&](int v) { return v < *peak; });
  const auto middle = 0.5F * static_cast<float>((peak - votes.begin()) + (peak_end - votes.begin())) / kBins;
  return file_end + sense * std::min(middle, width);
}

// A run of consecutive points taken for one scan line.
struct Line {
  std::size_t begin = 0;
  std::size_t end = 0;
  double mean_slope = 0.0;
};

double squared_deviation(std::span<const float> values, double center) {
  double sum = 0.0;
  for (const float v : values) sum += (v - center) * (v - center);
  return sum;
}

double mean_slope(const Line& line, std::span<const float> slope) {
  return mean(slope.subspan(line.begin, line.end - line.begin));
}

// The slopes of the points around a line's end, divided at one of them into what is left of either line.
struct Split {
  double step = 0.0;  // from the mean before to the mean after
  double squared_deviation = 0.0;
};

Split split_at(std::span<const float> slope, std::size_t end, std::size_t split, std::size_t reach) {
  const auto before = slope.subspan(end - 2 * reach, split - (end - 2 * reach));
  const auto after = slope.subspan(split, end + 2 * reach - split);
  const double mean_before = mean(before);
  const double mean_after = mean(after);
  return {mean_after - mean_before,
          squared_deviation(before, mean_before) + squared_deviation(after, mean_after)};
}

// Lines by azimuth alone: where it comes round. Small backward steps are motion compensation and parallax.
std::vector<Line> split_at_cut(const Angles& angles, int direction, float cut) {
  constexpr float kJitterTurns = 1.0F / 12.0F;
  std::vector<Line> lines{{0, 0, 0.0}};
  float last = 0.0F;
  for (std::size_t i = 0; i < angles.azimuth.size(); ++i) {
    float along = static_cast<float>(direction) * (angles.azimuth[i] - cut);
    along -= std::floor(along);
    const bool jitter_over_cut = along > last + 1.0F - kJitterTurns;
    if (jitter_over_cut) continue;
    if (along < last - kJitterTurns) {
      lines.back().end = i;
      lines.push_back({i, i, 0.0});
    }
    last = along;
  }
  lines.back().end = angles.azimuth.size();
  return lines;
}

// Moves the end of each line to where the vertical angle changes as it does from line to line, among the few
// points so near the cut that jitter may have carried them over it. The azimuth's answer stands unless
// another is clearly better: range steps change the vertical angle too.
void refine_ends(std::vector<Line>& lines, const Angles& angles, float cut) {
  constexpr std::size_t kReach = 4;
  constexpr float kJitterTurns = 0.5F / 360.0F;
  constexpr double kClearlyBetter = 0.25;
  const std::span<const float> slope = angles.slope;
  const double total_step = mean_slope(lines.back(), slope) - mean_slope(lines.front(), slope);
  for (std::size_t k = 0; k + 1 < lines.size(); ++k) {
    const std::size_t end = lines[k].end;
    if (end < lines[k].begin + 2 * kReach || end + 2 * kReach > lines[k + 1].end) continue;
    const auto near_cut = [&](std::size_t i) {
      return std::abs(shortest(angles.azimuth[i] - cut)) < kJitterTurns;
    };
    std::size_t best = end;
    double best_cost = kClearlyBetter * split_at(slope, end, end, kReach).squared_deviation;
    const auto consider = [&](std::size_t split) {
      const Split s = split_at(slope, end, split, kReach);
      if (s.squared_deviation >= best_cost || s.step * total_step <= 0.0) return;
      best = split;
      best_cost = s.squared_deviation;
    };
    for (std::size_t i = end; i > end - kReach && near_cut(i - 1); --i) consider(i - 1);
    for (std::size_t i = end; i < end + kReach && near_cut(i); ++i) consider(i + 1);
    lines[k].end = lines[k + 1].begin = best;
  }
}

void measure_slopes(std::vector<Line>& lines, std::span<const float> slope) {
  for (Line& line : lines) line.mean_slope = mean_slope(line, slope);
}

// Joins neighbours of one elevation: those the least apart while there are more than the sensor has, or,
// without that knowledge, those that do not go on in the common sense.
void join_split_lines(std::vector<Line>& lines, std::size_t sensor_rings) {
  while (lines.size() > 1) {
    const double sense = lines.back().mean_slope < lines.front().mean_slope ? 1.0 : -1.0;
    const auto drop = [&](std::size_t k) { return sense * (lines[k].mean_slope - lines[k + 1].mean_slope); };
    std::size_t least = 0;
    for (std::size_t k = 1; k + 1 < lines.size(); ++k) {
      if (drop(k) < drop(least)) least = k;
    }
    const bool too_many = sensor_rings > 0 && lines.size() > sensor_rings;
    if (!too_many && drop(least) > 0.0) return;
    Line& kept = lines[least];
    const Line& joined = lines[least + 1];
    const auto kept_size = static_cast<double>(kept.end - kept.begin);
    const auto joined_size = static_cast<double>(joined.end - joined.begin);
    kept.mean_slope =
        (kept_size * kept.mean_slope + joined_size * joined.mean_slope) / (kept_size + joined_size);
    kept.end = joined.end;
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(least) + 1);
  }
}

// Which of the sensor's rings the lines are when some are absent: the increasing assignment whose steps of
// elevation agree best. A common bias (mounting, road slope) cancels in the steps; the elevations themselves
// only break ties.
std::vector<std::uint16_t> match_rings(const std::vector<double>& found_deg,
                                       const std::vector<double>& sensor_deg) {
  constexpr double kTieBreak = 0.05;
  const std::size_t count = found_deg.size();
  const std::size_t rings = sensor_deg.size();
  constexpr double kNever = std::numeric_limits<double>::infinity();
  std::vector<std::vector<double>> cost(count, std::vector<double>(rings, kNever));
  std::vector<std::vector<std::size_t>> previous(count, std::vector<std::size_t>(rings, 0));
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t ring = k; ring < rings; ++ring) {
      const double bias = kTieBreak * std::abs(found_deg[k] - sensor_deg[ring]);
      if (k == 0) cost[k][ring] = bias;
      for (std::size_t before = 0; k > 0 && before < ring; ++before) {
        const double step = found_deg[k - 1] - found_deg[k] - (sensor_deg[before] - sensor_deg[ring]);
        const double total = cost[k - 1][before] + std::abs(step) + bias;
        if (total < cost[k][ring]) {
          cost[k][ring] = total;
          previous[k][ring] = before;
        }
      }
    }
  }
  std::vector<std::uint16_t> result(count);
  auto ring = static_cast<std::size_t>(std::min_element(cost.back().begin(), cost.back().end()) -
                                       cost.back().begin());
  for (std::size_t k = count; k-- > 0;) {
    result[k] = static_cast<std::uint16_t>(ring);
    ring = previous[k][ring];
  }
  return result;
}

// Share of the slopes' variance that is left within the lines: near 0 for scan lines, near 1 for any other
// order.
double variance_within(const std::vector<Line>& lines, std::span<const float> slope) {
  double within = 0.0;
  for (const Line& line : lines) {
    within += squared_deviation(slope.subspan(line.begin, line.end - line.begin), line.mean_slope);
  }
  const double total = squared_deviation(slope, mean(slope));
  return total > 0.0 ? within / total : 1.0;
}

std::size_t moved_points(const std::vector<Line>& by_azimuth, const std::vector<Line>& refined) {
  std::size_t moved = 0;
  for (std::size_t k = 0; k < by_azimuth.size(); ++k) {
    moved += std::max(by_azimuth[k].end, refined[k].end) - std::min(by_azimuth[k].end, refined[k].end);
  }
  return moved;
}

RingRecovery no_rings(std::span<Point> points, std::string problem) {
  for (Point& point : points) point.ring = Point::kNoRing;
  RingRecovery result;
  result.problem = std::move(problem);
  return result;
}

// A ring that came with the points.
struct RingSlope {
  std::uint16_t ring = 0;
  double mean_slope = 0.0;
};

// The rings present, by number.
std::vector<RingSlope> measure_rings(std::span<const Point> points) {
  const Angles angles = measure_angles(points);
  std::vector<double> sum(Point::kNoRing, 0.0);
  std::vector<std::size_t> count(Point::kNoRing, 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::uint16_t ring = points[i].ring;
    if (ring == Point::kNoRing) continue;
    sum[ring] += angles.slope[i];
    ++count[ring];
  }
  std::vector<RingSlope> rings;
  for (std::uint16_t ring = 0; ring < Point::kNoRing; ++ring) {
    if (count[ring] > 0) rings.push_back({ring, sum[ring] / static_cast<double>(count[ring])});
  }
  return rings;
}

// Numbers the lines from the highest and writes the rings.
RingRecovery assign_rings(std::span<Point> points, std::vector<Line> lines, const SensorConfig& sensor) {
  if (lines.back().mean_slope > lines.front().mean_slope) std::reverse(lines.begin(), lines.end());
  RingRecovery result;
  result.recovered = true;
  result.rings = lines.size();
  for (const Line& line : lines) result.elevation_deg.push_back(std::atan(line.mean_slope) * kRadToDeg);
  result.monotone_elevations =
      std::is_sorted(result.elevation_deg.rbegin(), result.elevation_deg.rend(), std::less_equal<>{});
  std::vector<std::uint16_t> ring_of_line(lines.size());
  std::iota(ring_of_line.begin(), ring_of_line.end(), std::uint16_t{0});
  const std::vector<double> sensor_deg = sensor.elevations_deg();
  if (lines.size() < sensor_deg.size()) ring_of_line = match_rings(result.elevation_deg, sensor_deg);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    for (std::size_t i = lines[k].begin; i < lines[k].end; ++i) points[i].ring = ring_of_line[k];
  }
  return result;
}

}  // namespace

RingRecovery recover_rings(std::span<Point> points, const SensorConfig& sensor) {
  constexpr std::size_t kFewestPoints = 16;
  constexpr std::size_t kMostLines = 1024;
  constexpr double kMostVarianceWithin = 0.25;
  constexpr double kMostSplit = 1.25;
  if (points.size() < kFewestPoints) return no_rings(points, "too few points to see scan lines in");
  const Angles angles = measure_angles(points);
  const int direction = storage_direction(angles.azimuth);
  if (direction == 0) return no_rings(points, "the azimuth does not run one way: not stored line by line");
  const float cut = find_cut(angles, direction);
  const std::vector<Line> by_azimuth = split_at_cut(angles, direction, cut);
  if (by_azimuth.size() < 2)
    return no_rings(points, "the azimuth never comes round: not stored line by line");
  if (by_azimuth.size() > kMostLines) {
    return no_rings(points,
                    fmt::format("{} wraps of the azimuth: not stored line by line", by_azimuth.size()));
  }
  const auto sensor_rings = static_cast<std::size_t>(sensor.rings);
  if (sensor_rings > 0 && static_cast<double>(by_azimuth.size()) > kMostSplit * sensor.rings) {
    return no_rings(points,
                    fmt::format("{} scan lines, but the sensor has {}", by_azimuth.size(), sensor_rings));
  }
  std::vector<Line> lines = by_azimuth;
  refine_ends(lines, angles, cut);
  std::size_t corrected = moved_points(by_azimuth, lines);
  measure_slopes(lines, angles.slope);
  join_split_lines(lines, sensor_rings);
  if (lines.size() < 2 || variance_within(lines, angles.slope) > kMostVarianceWithin) {
    return no_rings(points, "the vertical angle contradicts the lines that the azimuth shows");
  }
  RingRecovery result = assign_rings(points, std::move(lines), sensor);
  result.corrected_share = static_cast<double>(corrected) / static_cast<double>(points.size());
  return result;
}

bool order_rings(std::span<Point> points, const SensorConfig& sensor) {
  std::vector<RingSlope> rings = measure_rings(points);
  if (rings.size() < 2) {
    for (Point& point : points) point.ring = Point::kNoRing;
    return false;
  }
  const auto higher = [](const RingSlope& a, const RingSlope& b) { return a.mean_slope > b.mean_slope; };
  if (std::is_sorted(rings.begin(), rings.end(), higher)) return true;
  const int lowest = std::max(sensor.rings - 1, static_cast<int>(rings.back().ring));
  const bool upside_down = std::is_sorted(rings.rbegin(), rings.rend(), higher);
  std::stable_sort(rings.begin(), rings.end(), higher);
  std::vector<std::uint16_t> renumbered(static_cast<std::size_t>(lowest) + 1, Point::kNoRing);
  for (std::size_t place = 0; place < rings.size(); ++place) {
    const std::uint16_t ring = rings[place].ring;
    renumbered[ring] = static_cast<std::uint16_t>(upside_down ? lowest - ring : static_cast<int>(place));
  }
  for (Point& point : points) {
    if (point.ring != Point::kNoRing) point.ring = renumbered[point.ring];
  }
  return true;
}

void recover_sweep_fractions(std::span<Point> points, const SensorConfig& sensor) {
  const auto start = static_cast<float>(sensor.start_azimuth_deg / 360.0);
  const float sense = sensor.clockwise ? -1.0F : 1.0F;
  for (Point& point : points) {
    const float along = sense * (azimuth_turns(point.p_lidar.x(), point.p_lidar.y()) - start);
    point.sweep_fraction = along - std::floor(along);
  }
}

void correct_vertical_angle(std::span<Point> points, double degrees) {
  const auto c = static_cast<float>(std::cos(degrees / kRadToDeg));
  const auto s = static_cast<float>(std::sin(degrees / kRadToDeg));
  for (Point& point : points) {
    Eigen::Vector3f& p = point.p_lidar;
    const float radius = std::sqrt(p.x() * p.x() + p.y() * p.y());
    if (radius == 0.0F) continue;
    const float scale = c - p.z() / radius * s;
    p = {p.x() * scale, p.y() * scale, p.z() * c + radius * s};
  }
}

}  // namespace mlo
