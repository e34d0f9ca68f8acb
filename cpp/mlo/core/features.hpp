#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/types.hpp"

namespace mlo {

/// A point of the environment with what its scan line says of the shape around it.
struct FeaturePoint {
  Eigen::Vector3f p_lidar = Eigen::Vector3f::Zero();  ///< where it was measured, at its own time [m]
  float sweep_fraction = 0.0F;                        ///< its time within the sweep, 0 start, 1 end
  float smoothness = 0.0F;                            ///< c of LOAM's Eq. (1), without unit; 0 flat
  float intensity = 0.0F;
  std::uint16_t ring = Point::kNoRing;
  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.p_lidar, self.sweep_fraction, self.smoothness, self.intensity, self.ring);
  }
};

/// One kind of feature: few well-chosen points to be matched, and many candidates to be matched against.
struct FeatureSet {
  std::vector<FeaturePoint> features;    ///< index f in the paper
  std::vector<FeaturePoint> candidates;  ///< index c in the paper
  static void archive(auto& self, auto& bytes) { bytes(self.features, self.candidates); }
};

/// A detected object and what it encloses, without ground (gamma of the paper).
struct ObjectPoints {
  Detection detection;
  std::vector<Point> points;
  std::vector<FeaturePoint> edge_candidates;  ///< gamma_c
  static void archive(auto& self, auto& bytes) { bytes(self.detection, self.points, self.edge_candidates); }
};

/// What perception makes of one scan (paper, section III-B).
struct Percept {
  FeatureSet ground;   ///< chi
  FeatureSet edge;     ///< psi, background
  FeatureSet surface;  ///< zeta, background
  std::vector<ObjectPoints> objects;
  double mean_ground_smoothness = 0.0;  ///< S_a, Eq. (1)
  std::size_t num_ground_points = 0;
  std::size_t num_ambiguous_points = 0;  ///< both ground and object: they take no part in anything
  static void archive(auto& self, auto& bytes) {
    bytes(self.ground, self.edge, self.surface, self.objects, self.mean_ground_smoothness,
          self.num_ground_points, self.num_ambiguous_points);
  }
};

}  // namespace mlo
