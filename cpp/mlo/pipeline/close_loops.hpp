#pragma once

#include <cstddef>
#include <vector>

#include "mlo/core/se3.hpp"
#include "mlo/pipeline/config.hpp"
#include "mlo/scene/scene_file.hpp"

namespace mlo {

/// What closing the loops of a run moves.
struct ClosedLoops {
  std::size_t candidates = 0;  ///< pairs of places that looked alike
  std::size_t loops = 0;       ///< of these, registered and agreed upon
  /// For each scan of the scene, what its pose and the objects in it are moved by in the map frame; empty
  /// without a loop.
  std::vector<SE3> corrections;
};

/// Looks for places that were passed before among the scans of a scene, registers what was seen there the
/// second time to what was seen the first time, and fits the trajectory to both.
/// @throws InputError when the scene is damaged
ClosedLoops close_loops(const SceneFile& scene, const PipelineConfig& config);

}  // namespace mlo
