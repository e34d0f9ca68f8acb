#pragma once

#include <memory>
#include <optional>

#include <Eigen/Core>

#include "mlo/simulator/scene.hpp"

namespace mlo::simulator {

/// What a ray met first.
struct RayHit {
  double range_m = 0.0;
  double cos_incidence = 1.0;  ///< of the angle between the ray and the surface's normal, in [0, 1]
  Surface surface = Surface::road;
  int object_id = 0;  ///< 0: static
};

/// A scene made ready for casting rays during one sweep at a time (Embree). Objects move between the sweep's
/// start and end: each ray sees them where they are at its own time.
class RayWorld {
 public:
  /// Keeps a reference to the scene.
  explicit RayWorld(const Scene& scene);
  ~RayWorld();
  RayWorld(const RayWorld&) = delete;
  RayWorld& operator=(const RayWorld&) = delete;

  /// Moves all objects; those farther than reach_m from the place are left out. Call before cast.
  void set_sweep(double start_s, double end_s, const Eigen::Vector3d& place_world, double reach_m);
  /// From any thread. The direction is of unit length; the fraction of the sweep is in [0, 1].
  std::optional<RayHit> cast(const Eigen::Vector3d& origin_world, const Eigen::Vector3d& direction_world,
                             double sweep_fraction, double max_range_m) const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace mlo::simulator
