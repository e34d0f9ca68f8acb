#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "mlo/core/sensor.hpp"
#include "mlo/detection/config.hpp"
#include "mlo/loops/config.hpp"
#include "mlo/mapping/config.hpp"
#include "mlo/odometry/config.hpp"
#include "mlo/perception/config.hpp"
#include "mlo/scene/config.hpp"
#include "mlo/tracking/config.hpp"

namespace mlo {

/// Which part of each scan is used.
enum class RegionOfInterest { full, camera };

struct InputConfig {
  RegionOfInterest roi = RegionOfInterest::full;
  double camera_half_angle_deg = 45.0;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("roi", roi,
          Choices<RegionOfInterest>{{"full", RegionOfInterest::full}, {"camera", RegionOfInterest::camera}},
          "full: the whole revolution; camera: only what lies ahead, as the paper does");
    visit("camera_half_angle_deg", camera_half_angle_deg, between(1.0, 180.0),
          "azimuths within this of straight ahead belong to the camera's view [deg]");
  }
};

/// The motion during and between sweeps.
struct MotionConfig {
  double reference_fraction = 0.5;
  double constant_motion_within_m = 0.1;
  double constant_motion_within_deg = 0.5;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("reference_fraction", reference_fraction, between(0.0, 1.0),
          "points are brought to this moment of their sweep: 1, its end, as in the paper; the middle halves "
          "the "
          "error of a wrong velocity");
    visit("constant_motion_within_m", constant_motion_within_m, between(0.0, 100.0),
          "map refinement starts from constant motion while odometry differs from it by less than this, else "
          "from odometry: smoother against quicker to follow; 0 always takes odometry [m]");
    visit("constant_motion_within_deg", constant_motion_within_deg, between(0.0, 180.0),
          "the same for the rotation [deg]");
  }
};

/// Everything that can be configured, stage by stage.
struct PipelineConfig {
  SensorConfig sensor;
  InputConfig input;
  MotionConfig motion;
  PerceptionConfig perception;
  DetectionConfig detection;
  OdometryConfig odometry;
  MappingConfig mapping;
  TrackingConfig tracking;
  LoopClosureConfig loop_closure;
  SceneConfig scene;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit.group("sensor", sensor, "The lidar that took the scans.");
    visit.group("input", input, "Which part of the scans is used.");
    visit.group("motion", motion, "Motion during a sweep.");
    visit.group("perception", perception, "Ground, features and objects of one scan (paper, section III-B).");
    visit.group("detection", detection, "What finds objects where no boxes are given.");
    visit.group("odometry", odometry, "Scan-to-scan ego odometry (paper, section III-C-1).");
    visit.group("mapping", mapping, "Map refinement and the static map (paper, section III-D).");
    visit.group("tracking", tracking, "Multi-object tracking (paper, section III-C-2).");
    visit.group("loop_closure", loop_closure, "What is done about places that the robot comes back to.");
    visit.group("scene", scene, "The 4D file that a run writes (docs/scene_format.md).");
  }
  std::vector<std::string> find_problems() const {
    if (!loop_closure.enabled || (scene.write && scene.clouds)) return {};
    return {"loop_closure.enabled needs the clouds of the scene: set scene.write and scene.clouds to true"};
  }
};

/// Where a configuration comes from, in the order in which it is applied: later ones win.
struct ConfigArguments {
  std::vector<std::string> presets = {};
  std::optional<std::filesystem::path> file = {};
  std::vector<std::string> settings = {};  ///< "key=value"
};

/// `base` changed by presets, file and settings, and checked as a whole.
/// @throws InputError naming preset or file and line, key, value, what is allowed, and the nearest known name
PipelineConfig resolve(const ConfigArguments& arguments, const PipelineConfig& base = {});

/// The whole configuration as commented YAML; resolve() of it as a file gives the same configuration.
std::string to_yaml(PipelineConfig config);

}  // namespace mlo
