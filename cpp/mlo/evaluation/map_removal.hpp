#pragma once

#include <cstddef>
#include <optional>
#include <span>

#include <Eigen/Core>

#include "mlo/core/labelled_point.hpp"

namespace mlo {

struct MapRemovalOptions {
  double voxel_m = 0.2;  ///< side of the voxels of preservation and rejection rate (ERASOR: 0.2)
  /// A labelled point is in the map if one of the map's points is no farther: half the side of the map's
  /// voxels (DynamicMap_Benchmark: 0.05 for maps of 0.1 m voxels).
  double distance_m = 0.1;
};

/// How well a map keeps what is at rest and leaves out what moves. Measures are shares in [0, 1]; none where
/// there is nothing to count.
struct MapRemoval {
  // By voxels of the labelled points; one belongs to what most of its points are, at rest if they tie. It is
  // kept if the map has a point within half a voxel's diagonal of the mean of its points: where the grid of
  // the map lies does not matter.
  std::size_t static_voxels = 0;
  std::size_t dynamic_voxels = 0;
  std::size_t static_voxels_kept = 0;
  std::size_t dynamic_voxels_kept = 0;
  // By labelled points.
  std::size_t static_points = 0;
  std::size_t dynamic_points = 0;
  std::size_t static_points_kept = 0;  ///< those with a point of the map nearby
  std::size_t dynamic_points_kept = 0;

  /// ERASOR (Lim et al., RA-L 2021): static voxels kept of all; dynamic voxels not kept of all; harmonic
  /// mean.
  std::optional<double> preservation_rate() const;
  std::optional<double> rejection_rate() const;
  std::optional<double> f1() const;
  /// DynamicMap_Benchmark (Zhang et al., ITSC 2023): static points kept of all; dynamic points not kept of
  /// all; sqrt(SA * DA).
  std::optional<double> static_accuracy() const;
  std::optional<double> dynamic_accuracy() const;
  std::optional<double> associated_accuracy() const;
};

/// @param truth  labelled points; those of unknown mobility and those that are not finite do not count
/// @param map    points in the same frame; those that are not finite are left out
MapRemoval map_removal(std::span<const LabelledPoint> truth, std::span<const Eigen::Vector3f> map,
                       const MapRemovalOptions& options = {});

}  // namespace mlo
