#pragma once

#include <cstdint>

#include "mlo/core/box.hpp"
#include "mlo/simulator/mesh.hpp"

namespace mlo::simulator {

/// How a surface answers a laser.
struct SurfaceOptics {
  double reflectance = 0.3;  ///< diffuse, 0 to 1
  double loss = 0.0;         ///< share of the pulses that are mirrored away or pass through
};
SurfaceOptics optics(Surface surface);

/// SemanticKITTI's class number of a static surface, and of an object (moving ones have numbers of their
/// own).
std::uint16_t semantic_label(Surface surface);
std::uint16_t semantic_label(ObjectClass object_class, bool moving);

}  // namespace mlo::simulator
