#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/core/se3.hpp"
#include "mlo/simulator/camera.hpp"
#include "mlo/simulator/lidar_model.hpp"
#include "mlo/simulator/ray_world.hpp"
#include "mlo/simulator/scene.hpp"

namespace mlo::simulator {

/// One object at the stamp of a scan.
struct ObjectTruth {
  int id = 0;
  ObjectClass object_class = ObjectClass::car;
  SE3 T_world_object;  ///< body-fixed frame: centre of the box, x ahead
  Eigen::Vector3d velocity_world_mps = Eigen::Vector3d::Zero();
  double yaw_rate_radps = 0.0;
  bool moving = false;         ///< faster than kRest_mps at the stamp
  bool detectable = true;      ///< false: no detector reports it
  Box3d box_lidar;             ///< upright in the lidar frame, as labels are
  std::size_t points = 0;      ///< returns of this sweep from it
  double visible_share = 0.0;  ///< of the sides that face the lidar

  static constexpr double kRest_mps = 0.05;
};

/// Objects whose centre lies within reach_m of the lidar, in the order of their ids.
/// @param world  as set for the sweep
std::vector<ObjectTruth> objects_at(const Scene& scene, const RayWorld& world, const Sweep& sweep,
                                    double reach_m);

/// Class of a point as SemanticKITTI numbers them in the lower 16 bits (static classes, movable at rest,
/// moving), the object's id in the upper 16 bits.
/// @param objects  in the order of their ids
std::uint32_t point_label(const SimulatedPoint& point, const std::vector<ObjectTruth>& objects);

/// Fewer returns than this: an object is neither labelled nor reported by detectors.
constexpr std::size_t kMinLabelPoints = 5;

/// Lines of a KITTI tracking label file for what the camera sees.
std::string label_lines(const Rig& rig, std::size_t frame, const std::vector<ObjectTruth>& objects);

/// Lines of objects.csv; poses and velocities in the map frame.
std::string object_csv_header();
std::string object_csv_lines(const SE3& T_map_world, std::size_t frame,
                             const std::vector<ObjectTruth>& objects);

}  // namespace mlo::simulator
