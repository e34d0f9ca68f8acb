#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mlo/core/features.hpp"
#include "mlo/perception/config.hpp"
#include "mlo/perception/fusion.hpp"
#include "mlo/perception/scan_lines.hpp"

namespace mlo {

/// Points chosen on the scan lines, as indices into the scan, line by line and best first in each segment.
/// Near a chosen point its line gives no second one of the same family (ground; background; object).
struct ChosenPoints {
  std::vector<std::uint32_t> ground;           ///< flattest of each segment of V_g: chi_f
  std::vector<std::uint32_t> edges;            ///< sharpest background of each segment of V_b: psi_f
  std::vector<std::uint32_t> edge_candidates;  ///< those and more of them, less sharp: psi_c
  std::vector<std::uint32_t> surfaces;         ///< flattest background of each segment of V_b: zeta_f
  std::vector<std::uint32_t> object_edges;     ///< sharpest object points of each segment of V_b: gamma_c
};

ChosenPoints choose_points(const ScanLines& lines, const LineShape& shape, const SegmentedLines& segments,
                           std::span<const PointKind> kinds, const FeatureConfig& config);

/// The points by index, with their smoothness.
std::vector<FeaturePoint> gather_features(std::span<const Point> points, const LineShape& shape,
                                          std::span<const std::uint32_t> indices);

/// All points of a kind, the first of each voxel in scan order, those at `excluded` left out.
std::vector<FeaturePoint> gather_candidates(std::span<const Point> points, const LineShape& shape,
                                            std::span<const PointKind> kinds, PointKind kind,
                                            std::span<const std::uint32_t> excluded, double voxel_m);

/// Features for points on no scan line, where no neighbours tell which are best: those among the candidates,
/// the first of each (large) voxel.
std::vector<FeaturePoint> choose_without_lines(std::span<const FeaturePoint> candidates, double voxel_m);

/// S_a, Eq. (1): mean smoothness; 0 without features.
double mean_smoothness(std::span<const FeaturePoint> features);

}  // namespace mlo
