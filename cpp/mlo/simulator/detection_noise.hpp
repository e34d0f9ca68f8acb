#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"
#include "mlo/core/fields.hpp"
#include "mlo/core/random.hpp"
#include "mlo/simulator/camera.hpp"
#include "mlo/simulator/ground_truth.hpp"

namespace mlo::simulator {

/// What separates a detector from the truth. All errors are independent from object to object and from scan
/// to scan; real detectors repeat their mistakes more than that. The defaults resemble a good detector on
/// KITTI; all zero gives perfect detections with confidence 1.
struct DetectorErrors {
  double position_m = 0.05;       ///< standard deviation in x and y at no distance; half of it in z
  double position_per_m = 0.003;  ///< and what it grows by per metre of distance
  double size_share = 0.03;       ///< standard deviation of each side, as a share of it
  double yaw_rad = 0.03;
  double yaw_per_m = 0.0008;     ///< [rad per m]
  double flip_share = 0.02;      ///< boxes turned by half a turn
  double miss_share = 0.02;      ///< missed although well visible
  double half_points = 12.0;     ///< of objects with this many returns, every other is missed
  double false_positives = 0.3;  ///< per scan, on average
  double score_noise = 1.0;      ///< standard deviation of the logit of the confidence
  double max_range_m = 70.0;     ///< nothing is reported beyond

  static DetectorErrors none();

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("position_m", position_m, between(0.0, 10.0),
          "noise of x and y close to the lidar; half of it in z [m]");
    visit("position_per_m", position_per_m, between(0.0, 1.0),
          "growth of that noise per metre of distance [m/m]");
    visit("size_share", size_share, between(0.0, 1.0), "noise of each side as a share of it");
    visit("yaw_rad", yaw_rad, between(0.0, 3.2), "noise of the yaw close to the lidar [rad]");
    visit("yaw_per_m", yaw_per_m, between(0.0, 1.0), "growth of that noise per metre of distance [rad/m]");
    visit("flip_share", flip_share, between(0.0, 1.0), "share of boxes turned by half a turn");
    visit("miss_share", miss_share, between(0.0, 1.0), "share of well visible objects that are missed");
    visit("half_points", half_points, between(0.0, 1e4), "returns at which half of the objects are missed");
    visit("false_positives", false_positives, between(0.0, 100.0),
          "boxes around nothing per scan, on average");
    visit("score_noise", score_noise, between(0.0, 10.0), "noise of the logit of the confidence");
    visit("max_range_m", max_range_m, between(0.0, 1000.0), "nothing is reported beyond [m]");
  }
};

/// What a detector makes of the objects around: all round, not only where a camera looks.
std::vector<Detection> detect(const std::vector<ObjectTruth>& objects, const DetectorErrors& errors,
                              Random random);

/// Lines of the files that AB3DMOT reads: `frame,type,x1,y1,x2,y2,score,h,w,l,x,y,z,ry,alpha` with type 1
/// pedestrian, 2 car (also vans, which such detectors do not tell apart), 3 cyclist; others are left out, as
/// is what the camera does not see. The score is a logit.
std::string ab3dmot_lines(const Rig& rig, std::size_t frame, const std::vector<Detection>& detections);

}  // namespace mlo::simulator
