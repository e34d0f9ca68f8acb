#include "mlo/loops/place_descriptor.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mlo {
namespace {

constexpr float kMaxRange_m = 80.0F;
constexpr float kBelowLidar_m = 2.0F;
constexpr int kSectors = PlaceDescriptor::kSectors;

// Of the sectors, so many must have something in both places; fewer say nothing.
constexpr int kMinSectors = kSectors / 3;

using Heights = Eigen::Matrix<float, PlaceDescriptor::kRings, kSectors>;

// 1 less the mean cosine between the sectors, where `second` is turned by some sectors.
double difference(const Heights& first, const Heights& second, int turn) {
  double sum = 0.0;
  int count = 0;
  for (int sector = 0; sector < kSectors; ++sector) {
    const auto a = first.col(sector);
    const auto b = second.col((sector - turn + kSectors) % kSectors);
    const float norms = a.norm() * b.norm();
    if (norms == 0.0F) continue;
    sum += static_cast<double>(a.dot(b) / norms);
    ++count;
  }
  return count < kMinSectors ? 1.0 : 1.0 - sum / count;
}

}  // namespace

PlaceDescriptor::PlaceDescriptor(std::span<const Eigen::Vector3f> points_lidar) {
  for (const Eigen::Vector3f& p : points_lidar) {
    const float range_m = p.head<2>().norm();
    if (!p.allFinite() || range_m >= kMaxRange_m) continue;
    const float turn = (std::atan2(p.y(), p.x()) / std::numbers::pi_v<float> + 1.0F) / 2.0F;
    const int ring = static_cast<int>(range_m / kMaxRange_m * kRings);
    const int sector = std::min(static_cast<int>(turn * kSectors), kSectors - 1);
    heights_m_(ring, sector) = std::max(heights_m_(ring, sector), p.z() + kBelowLidar_m);
  }
}

PlaceDifference compare(const PlaceDescriptor& first, const PlaceDescriptor& second) {
  PlaceDifference best;
  for (int turn = 0; turn < kSectors; ++turn) {
    const double value = difference(first.heights_m(), second.heights_m(), turn);
    if (value >= best.value) continue;
    const int signed_turn = turn > kSectors / 2 ? turn - kSectors : turn;
    best = {value, 2.0 * std::numbers::pi * signed_turn / kSectors};
  }
  return best;
}

}  // namespace mlo
