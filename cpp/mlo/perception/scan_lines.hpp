#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"
#include "mlo/perception/config.hpp"

namespace mlo {

/// The points of a scan by scan line. Points without a ring are on no line.
struct ScanLines {
  std::vector<std::uint32_t> order;  ///< indices of points, line after line, in each as the scan has them
  std::vector<std::size_t> begin;    ///< where each line begins in `order`, and where the last one ends

  std::size_t num_lines() const { return begin.empty() ? 0 : begin.size() - 1; }
};

/// Groups points by ring. Points of a ring must come in order of azimuth, whichever the rings' own order.
ScanLines group_lines(std::span<const Point> points);

/// What its neighbours on the scan line say of each point of the scan.
struct LineShape {
  /// c of LOAM's Eq. (1), |sum_j (p_j - p_i)| / (|S| |p_i|) over the 5 neighbours on each side (fewer at the
  /// ends of a line); without unit, 0 flat, and 0 for points on no line.
  std::vector<float> smoothness;
  /// 0: no feature: at a border that another surface hides or on one seen almost along (LOAM, Fig. 4), or
  /// with fewer neighbours, or on no line.
  std::vector<std::uint8_t> reliable;
};

/// Coordinates must be finite.
LineShape measure_lines(std::span<const Point> points, const ScanLines& lines);

/// Neighbouring places in ScanLines::order, head and tail included, all ground or all background.
struct PointRun {
  std::uint32_t head = 0;
  std::uint32_t tail = 0;
};

/// The runs of one kind, segment after segment: V_g or V_b of the paper.
struct SegmentRuns {
  std::vector<PointRun> runs;
  std::vector<std::size_t> begin;  ///< where each segment begins in `runs`, and where the last one ends

  std::size_t num_segments() const { return begin.empty() ? 0 : begin.size() - 1; }
  std::span<const PointRun> segment(std::size_t i) const {
    return std::span<const PointRun>(runs).subspan(begin[i], begin[i + 1] - begin[i]);
  }
};

struct SegmentedLines {
  SegmentRuns ground;      ///< V_g
  SegmentRuns background;  ///< V_b
};

/// Cuts each line into segments_per_line equal parts and lists the runs of ground and background in each.
/// @param is_ground  per point of the scan: 1 ground, 0 background
SegmentedLines segment_lines(const ScanLines& lines, std::span<const std::uint8_t> is_ground,
                             int segments_per_line);

}  // namespace mlo
