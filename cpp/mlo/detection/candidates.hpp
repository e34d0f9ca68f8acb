#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/detection/cell_grid.hpp"
#include "mlo/detection/config.hpp"
#include "mlo/detection/ground_heights.hpp"

namespace mlo {

/// What the model judges a candidate by.
inline constexpr std::array<std::string_view, 14> kCandidateFeatures{
    "length",        // seen length over the typical one
    "width",         // seen width over the typical one
    "top",           // height of the highest return over the typical height
    "bottom",        // height of the lowest one [m]
    "returns",       // decimal logarithm of their number
    "range",         // [50 m]
    "off_sides",     // mean distance of the returns from the two sides that they lie at [0.2 m]
    "upper",         // share of returns in the upper 40 % of the typical height
    "lower",         // and in the lower 30 %
    "overhang",      // share of cells with returns above the typical height
    "steepness",     // mean height that the returns of a cell span over the typical height
    "crowded",       // share of places 0.5 m around the box that hold other returns
    "others",        // share of places in the box with returns that belong to something else
    "ground_inside"  // share of places well inside the box where the ground is seen
};
using CandidateFeatures = std::array<double, kCandidateFeatures.size()>;

/// A cluster taken for an object of a class.
struct Candidate {
  ObjectClass object_class = ObjectClass::car;
  Box3d box;
  CandidateFeatures features = {};
};

/// Size that an object of a class has where it is not seen, and the most that may be seen of it.
struct ClassSize {
  ObjectClass object_class = ObjectClass::car;
  Eigen::Vector3d typical_lwh_m = Eigen::Vector3d::Zero();
  Eigen::Vector2d max_lw_m = Eigen::Vector2d::Zero();
};
/// The classes that are looked for.
std::span<const ClassSize> class_sizes();

/// Everything that a cluster may be: for each class whose size bounds it, with the box's length along either
/// side of the fitted rectangle. What is not seen of a typical object is added away from the lidar; the box
/// stands on the ground. Empty for clusters that are no object by size or have too few points.
std::vector<Candidate> candidates_of(const CellCluster& cluster, const CellGrid& grid,
                                     const GroundHeights& ground, const ClusterConfig& config);

}  // namespace mlo
