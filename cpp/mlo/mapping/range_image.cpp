#include "mlo/mapping/range_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "mlo/core/azimuth.hpp"

namespace mlo {
namespace {

constexpr int kMaxRows = 128;
// Elevations are compared by their tangents: cheaper, and nearly the same over a lidar's field of view.
float tangent(const Eigen::Vector3f& p) {
  return p.z() / p.head<2>().norm();
}

std::size_t index(int row, int column, int columns) {
  return static_cast<std::size_t>(row) * static_cast<std::size_t>(columns) + static_cast<std::size_t>(column);
}

// Scan lines that are in use, of those with known numbers.
int count_rings(std::span<const Point> points) {
  std::array<bool, kMaxRows> used{};
  for (const Point& point : points) {
    if (point.ring < kMaxRows) used[point.ring] = true;
  }
  return static_cast<int>(std::count(used.begin(), used.end(), true));
}

}  // namespace

RangeImage::RangeImage(std::span<const Point> points) {
  if (!points.empty()) set_rows(points);
  pixels_.resize(static_cast<std::size_t>(rows_) * kColumns);
  std::vector<float> fraction_sums(kColumns, 0.0F);
  std::vector<int> counts(kColumns, 0);
  top_rows_.assign(kColumns, -1);
  for (const Point& point : points) {
    const int c = column(point.p_lidar);
    const int r = row(point.p_lidar);
    Pixel& pixel = pixels_[index(r, c, kColumns)];
    int& top_row = top_rows_[static_cast<std::size_t>(c)];
    top_row = std::max(top_row, r);
    const float range_m = point.p_lidar.norm();
    pixel.nearest_m = pixel.nearest_m > 0.0F ? std::min(pixel.nearest_m, range_m) : range_m;
    pixel.farthest_m = std::max(pixel.farthest_m, range_m);
    fraction_sums[static_cast<std::size_t>(c)] += point.sweep_fraction;
    ++counts[static_cast<std::size_t>(c)];
  }
  sweep_fractions_.assign(kColumns, 0.5F);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] > 0) sweep_fractions_[c] = fraction_sums[c] / static_cast<float>(counts[c]);
  }
}

void RangeImage::set_rows(std::span<const Point> points) {
  float highest = -std::numeric_limits<float>::max();
  lowest_tangent_ = std::numeric_limits<float>::max();
  for (const Point& point : points) {
    const float t = tangent(point.p_lidar);
    lowest_tangent_ = std::min(lowest_tangent_, t);
    highest = std::max(highest, t);
  }
  rows_ = std::max(1, count_rings(points));
  const float height = (highest - lowest_tangent_) * 1.0001F;
  inverse_row_height_ = height > 0.0F ? static_cast<float>(rows_) / height : 0.0F;
}

int RangeImage::column(const Eigen::Vector3f& p_lidar) {
  return std::min(kColumns - 1, static_cast<int>(azimuth_turns(p_lidar.x(), p_lidar.y()) * kColumns));
}

int RangeImage::row(const Eigen::Vector3f& p_lidar) const {
  return static_cast<int>(std::floor((tangent(p_lidar) - lowest_tangent_) * inverse_row_height_));
}

const RangeImage::Pixel& RangeImage::at(int row, int column) const {
  const int wrapped = (column + kColumns) % kColumns;
  return pixels_[index(row, wrapped, kColumns)];
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
    const int top_row = top_rows_[static_cast<std::size_t>((j + kColumns) % kColumns)];
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
  for (int j = c - 1; j <= c + 1; ++j) {
    const Pixel& pixel = at(r, j);
    if (pixel.nearest_m > 0.0F && pixel.nearest_m < range_m + margin_m) return Sight::unknown;
  }
  return Sight::through;
}

}  // namespace mlo
