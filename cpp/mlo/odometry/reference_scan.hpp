#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <numbers>
#include <optional>
#include <type_traits>
#include <vector>

#include "mlo/core/azimuth.hpp"
#include "mlo/core/features.hpp"
#include "mlo/core/sweep_motion.hpp"

namespace mlo {

/// A place from which scan lines are searched, with what every search of it needs.
struct RingQuery {
  explicit RingQuery(const Eigen::Vector3d& p_lidar)
      : p(p_lidar.cast<float>()), azimuth_rad(mlo::azimuth_rad(p.x(), p.y())), range_m(p.head<2>().norm()) {}
  Eigen::Vector3f p;
  float azimuth_rad;
  float range_m;
};

/// Candidates of one kind, without motion distortion, searchable by distance and along scan lines. Immutable.
/// Points are sorted by ring and azimuth; indices are into that order. Points that are not finite are left
/// out.
class CandidateSet {
 public:
  CandidateSet();
  /// @param max_points  more points are thinned evenly, in their order
  CandidateSet(const std::vector<FeaturePoint>& candidates, const SweepMotion& motion,
               std::size_t max_points);
  ~CandidateSet();
  CandidateSet(CandidateSet&&) noexcept;
  CandidateSet& operator=(CandidateSet&&) noexcept;

  std::size_t size() const { return points_.size(); }
  /// In the lidar frame at the reference time [m].
  Eigen::Vector3d point(std::size_t index) const { return points_[index].cast<double>(); }
  /// FeaturePoint::ring; Point::kNoRing where it is not known.
  std::uint16_t ring(std::size_t index) const { return rings_[index]; }

  /// The nearest candidate, if it is nearer than max_distance_m.
  std::optional<std::size_t> nearest(const Eigen::Vector3d& p, double max_distance_m) const;
  /// Up to count candidates nearer than max_distance_m, nearest first.
  std::vector<std::size_t> nearest(const Eigen::Vector3d& p, std::size_t count, double max_distance_m) const;
  /// The nearest candidate of a ring, nearer than max_distance_m, for which accept(point) is true.
  template <class Accept>
  std::optional<std::size_t> nearest_on_ring(const RingQuery& query, std::size_t ring, double max_distance_m,
                                             const Accept& accept) const;

  /// See core/archive.hpp; the search structure is built anew.
  static void archive(auto& self, auto& bytes) {
    bytes(self.points_, self.rings_, self.azimuths_, self.ring_begin_);
    if constexpr (std::remove_reference_t<decltype(bytes)>::kReads) self.build_tree();
  }

 private:
  struct Tree;
  void build_tree();

  std::vector<Eigen::Vector3f> points_;
  std::vector<std::uint16_t> rings_;
  std::vector<float> azimuths_;          ///< [rad], growing within a ring
  std::vector<std::size_t> ring_begin_;  ///< first index of each ring, and the end
  std::unique_ptr<const Tree> tree_;
};

/// The previous scan as that to which the current one is matched: the sets with a bar of the paper.
struct ReferenceScan {
  CandidateSet ground;
  CandidateSet edge;
  CandidateSet surface;
  static void archive(auto& self, auto& bytes) { bytes(self.ground, self.edge, self.surface); }
};

/// Removes distortion by `motion` (SweepMotion::none() for motion-compensated scans) and builds the search
/// structures, all three kinds in parallel.
/// @param max_candidates  points of each kind that are kept at most
ReferenceScan make_reference_scan(const Percept& percept, const SweepMotion& motion,
                                  std::size_t max_candidates);

template <class Accept>
std::optional<std::size_t> CandidateSet::nearest_on_ring(const RingQuery& query, std::size_t ring,
                                                         double max_distance_m, const Accept& accept) const {
  if (ring + 1 >= ring_begin_.size()) return std::nullopt;
  const std::size_t begin = ring_begin_[ring];
  const std::size_t count = ring_begin_[ring + 1] - begin;
  if (count == 0) return std::nullopt;
  const auto first = azimuths_.begin() + static_cast<std::ptrdiff_t>(begin);
  const auto start = static_cast<std::size_t>(
      std::lower_bound(first, first + static_cast<std::ptrdiff_t>(count), query.azimuth_rad) - first);
  constexpr float kHalfTurn = std::numbers::pi_v<float>;

  const auto wrapped = [&](std::size_t offset) { return offset < count ? offset : offset - count; };

  std::optional<std::size_t> best;
  auto best_squared = static_cast<float>(max_distance_m * max_distance_m);
  // Walks away from the query's azimuth, once around at most, until no point farther on can be nearer: a
  // point at an azimuth difference d below a quarter turn is at least range * sin(d) away.
  const auto walk = [&](std::size_t offset, std::size_t step) {
    for (std::size_t i = 0; i < count; ++i, offset = wrapped(offset + step)) {
      float d = std::abs(azimuths_[begin + offset] - query.azimuth_rad);
      if (d > kHalfTurn) d = 2.0F * kHalfTurn - d;
      const float sine = d < 0.5F * kHalfTurn ? d - d * d * d / 6.0F : 0.83F;
      if (query.range_m * query.range_m * sine * sine > best_squared) return;
      const float squared = (points_[begin + offset] - query.p).squaredNorm();
      if (squared < best_squared && accept(points_[begin + offset])) {
        best_squared = squared;
        best = begin + offset;
      }
    }
  };
  walk(wrapped(start), 1);
  walk(wrapped(start + count - 1), count - 1);
  return best;
}

}  // namespace mlo
