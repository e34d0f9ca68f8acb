#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "mlo/core/labelled_point.hpp"

namespace mlo {

/// What to make of things that could move and rest, such as parked cars.
enum class Movable { counts_as_at_rest, is_left_out };

/// What a label of SemanticKITTI says of a point (Behley et al., ICCV 2019): classes 252 to 259 move, 0 and 1
/// (unlabelled, outlier) say nothing, all others are at rest: vehicles and people (10 to 32) if they count.
/// The upper 16 bits (the object) do not matter.
Mobility mobility_of(std::uint32_t semantic_label, Movable movable = Movable::counts_as_at_rest);

/// Labels of one scan: a little-endian uint32 for each of its points (SemanticKITTI's .label files).
/// @throws InputError if the file is missing or not a whole number of labels
std::vector<std::uint32_t> read_semantic_labels(const std::filesystem::path& file);

/// A labelled map: a PCD or PLY file with a field `label` (SemanticKITTI's numbers) or, without one, with
/// intensity 1 for what moves and 0 for what does not, as the ground truth of DynamicMap_Benchmark has it.
/// Points that are not finite are left out.
/// @throws InputError with file, line or byte, and remedy
std::vector<LabelledPoint> read_labelled_cloud(const std::filesystem::path& file,
                                               Movable movable = Movable::counts_as_at_rest);

}  // namespace mlo
