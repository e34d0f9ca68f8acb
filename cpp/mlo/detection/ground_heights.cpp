#include "mlo/detection/ground_heights.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mlo {
namespace {

constexpr float kCell_m = 2.0F;
constexpr float kUnknown = std::numeric_limits<float>::quiet_NaN();

}  // namespace

GroundHeights::GroundHeights(std::span<const Point> points, std::span<const std::uint8_t> is_ground,
                             double reach_m)
    : reach_m_(static_cast<float>(reach_m)), side_(static_cast<int>(std::ceil(2.0F * reach_m_ / kCell_m))) {
  const auto num_cells = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
  std::vector<float> sum(num_cells, 0.0F);
  std::vector<float> count(num_cells, 0.0F);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3f& p = points[i].p_lidar;
    if (is_ground[i] == 0 || p.head<2>().cwiseAbs().maxCoeff() >= reach_m_) continue;
    const std::size_t cell = place(index_of(p.x()), index_of(p.y()));
    sum[cell] += p.z();
    count[cell] += 1.0F;
  }
  z_.resize(num_cells);
  for (std::size_t cell = 0; cell < num_cells; ++cell) {
    z_[cell] = count[cell] > 0.0F ? sum[cell] / count[cell] : kUnknown;
    found_ = found_ || count[cell] > 0.0F;
  }
  if (found_) fill();
}

int GroundHeights::index_of(float coordinate) const {
  return std::clamp(static_cast<int>((coordinate + reach_m_) / kCell_m), 0, side_ - 1);
}

// Ring by ring outwards from what is known, each cell the mean of its neighbours that were known before.
void GroundHeights::fill() {
  for (bool all_known = false; !all_known;) {
    all_known = true;
    const std::vector<float> before = z_;
    for (int row = 0; row < side_; ++row) {
      for (int column = 0; column < side_; ++column) {
        float& z = z_[place(column, row)];
        if (!std::isnan(z)) continue;
        all_known = false;
        float sum = 0.0F;
        int known = 0;
        for (int r = std::max(row - 1, 0); r <= std::min(row + 1, side_ - 1); ++r) {
          for (int c = std::max(column - 1, 0); c <= std::min(column + 1, side_ - 1); ++c) {
            const float neighbor = before[place(c, r)];
            if (std::isnan(neighbor)) continue;
            sum += neighbor;
            ++known;
          }
        }
        if (known > 0) z = sum / static_cast<float>(known);
      }
    }
  }
}

float GroundHeights::at(const Eigen::Vector2f& p_lidar) const {
  if (!found_) return 0.0F;
  return z_[place(index_of(p_lidar.x()), index_of(p_lidar.y()))];
}

float GroundHeights::interpolated_at(const Eigen::Vector2f& p_lidar) const {
  const Eigen::Vector2f lower = p_lidar.array() - 0.5F * kCell_m;
  const auto share = [&](float coordinate) {
    const float cells = (coordinate + reach_m_) / kCell_m;
    return cells - std::floor(cells);
  };
  const float a = share(lower.x());
  const float b = share(lower.y());
  const Eigen::Vector2f upper = lower.array() + kCell_m;
  return (1.0F - b) * ((1.0F - a) * at(lower) + a * at({upper.x(), lower.y()})) +
         b * ((1.0F - a) * at({lower.x(), upper.y()}) + a * at(upper));
}

}  // namespace mlo
