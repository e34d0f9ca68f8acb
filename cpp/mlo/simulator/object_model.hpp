#pragma once

#include <vector>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/simulator/mesh.hpp"

namespace mlo::simulator {

/// A rigid piece of an object; it may swing about its pivot as the object moves (legs, arms).
/// Its frame is the object's ground frame: origin under the middle of the box, on the ground, x ahead, z up.
struct ModelPart {
  Mesh mesh;
  Eigen::Vector3d pivot_m = Eigen::Vector3d::Zero();  ///< the swing is about the y axis through it
  double swing_rad = 0.0;                             ///< amplitude; 0: rigid
  double cycles_per_m = 0.0;                          ///< of the way travelled
  double phase_rad = 0.0;

  /// Pose of the part in the object's ground frame after some way.
  SE3 T_ground_part(double travelled_m) const;
};

/// What an object looks like, and the box that always holds it.
struct ObjectModel {
  ObjectClass object_class = ObjectClass::car;
  Eigen::Vector3d size_lwh_m = Eigen::Vector3d::Zero();
  std::vector<ModelPart> parts;
};

/// Centres the parts under the smallest box that holds them in every phase of their swing.
ObjectModel make_model(ObjectClass object_class, std::vector<ModelPart> parts);

// Vehicles (vehicles.cpp), sizes drawn around those of European streets:
ObjectModel make_car(Random random);
ObjectModel make_van(Random random);
ObjectModel make_truck(Random random);
/// A railway carriage; of class `other`, which street detectors do not report.
ObjectModel make_carriage(double length_m);

// People (people.cpp):
ObjectModel make_pedestrian(Random random);
ObjectModel make_cyclist(Random random);

}  // namespace mlo::simulator
