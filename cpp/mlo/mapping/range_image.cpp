#include "mlo/mapping/range_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mlo {
namespace {

constexpr int kMaxRows = 128;
// Elevations are compared by their tangents: cheaper, and nearly the same over a lidar's field of view.
double tangent(const Eigen::Vector3d& p) {
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
  double highest = -std::numeric_limits<double>::max();
  lowest_tangent_ = std::numeric_limits<double>::max();
  for (const Point& point : points) {
    const double t = tangent(point.p_lidar.cast<double>());
    lowest_tangent_ = std::min(lowest_tangent_, t);
    highest = std::max(highest, t);
  }
  rows_ = points.empty() ? 0 : std::max(1, count_rings(points));
  inverse_row_height_ = highest > lowest_tangent_ ? rows_ / ((highest - lowest_tangent_) * 1.0001) : 0.0;
  pixels_.resize(static_cast<std::size_t>(rows_) * kColumns);
  std::vector<double> fraction_sums(kColumns, 0.0);
  std::vector<int> counts(kColumns, 0);
  for (const Point& point : points) {
    const Eigen::Vector3d p = point.p_lidar.cast<double>();
    const int c = column(p.x(), p.y());
    Pixel& pixel = pixels_[index(row(p), c, kColumns)];
    const auto range_m = static_cast<float>(p.norm());
    pixel.nearest_m = pixel.nearest_m > 0.0F ? std::min(pixel.nearest_m, range_m) : range_m;
    pixel.farthest_m = std::max(pixel.farthest_m, range_m);
    fraction_sums[static_cast<std::size_t>(c)] += static_cast<double>(point.sweep_fraction);
    ++counts[static_cast<std::size_t>(c)];
  }
  sweep_fractions_.assign(kColumns, 0.5F);
  for (std::size_t c = 0; c < counts.size(); ++c) {
    if (counts[c] > 0) sweep_fractions_[c] = static_cast<float>(fraction_sums[c] / counts[c]);
  }
}

int RangeImage::column(double x, double y) const {
  const double share =
      0.5 +
      0.5 * static_cast<double>(std::atan2(static_cast<float>(y), static_cast<float>(x))) / std::numbers::pi;
  return std::min(kColumns - 1, static_cast<int>(share * kColumns));
}

int RangeImage::row(const Eigen::Vector3d& p_lidar) const {
  return static_cast<int>(std::floor((tangent(p_lidar) - lowest_tangent_) * inverse_row_height_));
}

const RangeImage::Pixel& RangeImage::at(int row, int column) const {
  const int wrapped = (column + kColumns) % kColumns;
  return pixels_[index(row, wrapped, kColumns)];
}

double RangeImage::sweep_fraction(const Eigen::Vector3d& p_lidar) const {
  return static_cast<double>(sweep_fractions_[static_cast<std::size_t>(column(p_lidar.x(), p_lidar.y()))]);
}

Sight RangeImage::look(const Eigen::Vector3d& p_lidar, double margin_m) const {
  const int r = row(p_lidar);
  if (r < 0 || r >= rows_) return Sight::unknown;
  const int c = column(p_lidar.x(), p_lidar.y());
  const Pixel& middle = at(r, c);
  if (!(middle.nearest_m > 0.0F)) return Sight::unknown;
  const auto range_m = static_cast<float>(p_lidar.norm());
  const auto margin = static_cast<float>(margin_m);
  if (range_m > middle.nearest_m - margin && range_m < middle.farthest_m + margin) return Sight::hit;
  for (int j = c - 1; j <= c + 1; ++j) {
    const Pixel& pixel = at(r, j);
    if (pixel.nearest_m > 0.0F && pixel.nearest_m < range_m + margin) return Sight::unknown;
  }
  return Sight::through;
}

}  // namespace mlo
