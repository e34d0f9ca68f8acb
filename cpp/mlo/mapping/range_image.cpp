#include "mlo/mapping/range_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mlo/core/azimuth.hpp"

namespace mlo {
namespace {

constexpr int kMaxRows = 128;
// Columns for each point of a full scan line: with fewer, a place is only free with much around it; with
// more, rays miss pixels.
constexpr double kColumnsPerPoint = 0.75;
constexpr int kMinColumns = 360;
constexpr int kMaxColumns = 1440;
// A ray just below that ended within this before a place met the surface to which the place belongs [m].
constexpr float kSameSurfaceM = 2.0F;
// Elevations are compared by their tangents: cheaper, and nearly the same over a lidar's field of view.
float tangent(const Eigen::Vector3f& p) {
  return p.z() / p.head<2>().norm();
}

std::size_t index(int row, int column, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
}

// Points of each scan line, of those with known numbers.
std::array<int, kMaxRows> points_by_ring(std::span<const Point> points) {
  std::array<int, kMaxRows> counts{};
  for (const Point& point : points) {
    if (point.ring < kMaxRows) ++counts[point.ring];
  }
  return counts;
}

// Points that a scan line would have all round, were it as dense everywhere as where it has some.
double points_around(std::span<const Point> points, std::size_t ring) {
  constexpr std::size_t kSectors = 360;
  std::array<bool, kSectors> used{};
  int count = 0;
  for (const Point& point : points) {
    if (point.ring != ring) continue;
    const float turns = azimuth_turns(point.p_lidar.x(), point.p_lidar.y());
    used[std::min(kSectors - 1, static_cast<std::size_t>(turns * static_cast<float>(kSectors)))] = true;
    ++count;
  }
  const auto sectors = std::count(used.begin(), used.end(), true);
  return sectors > 0 ? static_cast<double>(count) * kSectors / static_cast<double>(sectors) : 0.0;
}

}  // namespace

RangeImage::RangeImage(std::span<const Point> points) {
  set_size(points);
  const auto columns = static_cast<std::size_t>(columns_);
  pixels_.resize(static_cast<std::size_t>(rows_) * columns);
  std::vector<float> fraction_sums(columns, 0.0F);
  std::vector<int> counts(columns, 0);
  top_rows_.assign(columns, -1);
  for (const Point& point : points) {
    const int c = column(point.p_lidar);
    const int r = row(point.p_lidar);
    Pixel& pixel = pixels_[index(r, c, columns_)];
    int& top_row = top_rows_[static_cast<std::size_t>(c)];
    top_row = std::max(top_row, r);
    const float range_m = point.p_lidar.norm();
    pixel.nearest_m = pixel.nearest_m > 0.0F ? std::min(pixel.nearest_m, range_m) : range_m;
    pixel.farthest_m = std::max(pixel.farthest_m, range_m);
    fraction_sums[static_cast<std::size_t>(c)] += point.sweep_fraction;
    ++counts[static_cast<std::size_t>(c)];
  }
  sweep_fractions_.assign(columns, 0.5F);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] > 0) sweep_fractions_[c] = fraction_sums[c] / static_cast<float>(counts[c]);
  }
}

void RangeImage::set_size(std::span<const Point> points) {
  if (points.empty()) return;
  float highest = -std::numeric_limits<float>::max();
  lowest_tangent_ = std::numeric_limits<float>::max();
  for (const Point& point : points) {
    const float t = tangent(point.p_lidar);
    lowest_tangent_ = std::min(lowest_tangent_, t);
    highest = std::max(highest, t);
  }
  const std::array<int, kMaxRows> counts = points_by_ring(points);
  const auto used = std::count_if(counts.begin(), counts.end(), [](int count) { return count > 0; });
  rows_ = std::max(1, static_cast<int>(used));
  const auto fullest =
      static_cast<std::size_t>(std::max_element(counts.begin(), counts.end()) - counts.begin());
  columns_ = std::clamp(static_cast<int>(kColumnsPerPoint * points_around(points, fullest)), kMinColumns,
                        kMaxColumns);
  const float height = (highest - lowest_tangent_) * 1.0001F;
  inverse_row_height_ = height > 0.0F ? static_cast<float>(rows_) / height : 0.0F;
}

int RangeImage::column(const Eigen::Vector3f& p_lidar) const {
  const float turns = azimuth_turns(p_lidar.x(), p_lidar.y());
  return std::min(columns_ - 1, static_cast<int>(turns * static_cast<float>(columns_)));
}

int RangeImage::row(const Eigen::Vector3f& p_lidar) const {
  return static_cast<int>(std::floor((tangent(p_lidar) - lowest_tangent_) * inverse_row_height_));
}

const RangeImage::Pixel& RangeImage::at(int row, int column) const {
  const int wrapped = (column + columns_) % columns_;
  return pixels_[index(row, wrapped, columns_)];
}

float RangeImage::sweep_fraction(const Eigen::Vector3f& p_lidar) const {
  return sweep_fractions_[static_cast<std::size_t>(column(p_lidar))];
}

bool RangeImage::is_empty_around(int row, int column) const {
  for (int i = std::max(0, row - 1); i <= std::min(rows_ - 1, row + 1); ++i) {
    for (int j = column - 1; j <= column + 1; ++j) {
      if (at(i, j).nearest_m > 0.0F) return false;
    }
  }
  return true;
}

// From the row below upwards. A direction without any ray was not looked at: it was cropped, or hidden.
bool RangeImage::is_sky(int row, int column) const {
  for (int j = column - 1; j <= column + 1; ++j) {
    const int top_row = top_rows_[static_cast<std::size_t>((j + columns_) % columns_)];
    if (top_row < 0 || top_row >= row - 1) return false;
  }
  return true;
}

Sight RangeImage::look(const Eigen::Vector3f& p_lidar, float margin_m) const {
  const int r = row(p_lidar);
  if (r < 0 || r >= rows_) return Sight::unknown;
  const int c = column(p_lidar);
  const Pixel& middle = at(r, c);
  if (!(middle.nearest_m > 0.0F)) {
    if (is_sky(r, c)) return Sight::sky;
    return is_empty_around(r, c) ? Sight::empty : Sight::unknown;
  }
  const float range_m = p_lidar.norm();
  if (range_m > middle.nearest_m - margin_m && range_m < middle.farthest_m + margin_m) return Sight::hit;
  const auto ended_since = [&](const Pixel& pixel, float from_m) {
    return pixel.nearest_m > 0.0F && pixel.nearest_m > from_m && pixel.nearest_m < range_m + margin_m;
  };
  for (int j = c - 1; j <= c + 1; ++j) {
    if (ended_since(at(r, j), 0.0F)) return Sight::unknown;
    if (r > 0 && ended_since(at(r - 1, j), range_m - kSameSurfaceM)) return Sight::unknown;
  }
  return Sight::through;
}

}  // namespace mlo
