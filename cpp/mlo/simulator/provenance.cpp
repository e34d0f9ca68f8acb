#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mlo/simulator/dataset_writer.hpp"

namespace mlo::simulator {
namespace {

constexpr const char* kLayoutTracking = R"(
velodyne/0000/NNNNNN.bin     scans as the sensor gives them (not motion-compensated): x y z intensity, float32,
                             ring by ring from the highest, by azimuth growing from ahead; elevations too low by
                             the bias in synthetic.json, as KITTI's are by 0.205 degrees
labels/0000/NNNNNN.label     uint32 per point: SemanticKITTI class in the lower 16 bits, object id in the upper 16;
                             10 car, 18 truck, 20 van and others, 30 person, 31 cyclist are movable and at rest,
                             252 to 259 are moving, all others are static
calib/0000.txt               calibration (values of its own; there are no images)
oxts/0000.txt                true pose of the IMU as latitude, longitude, height, roll, pitch, yaw and rates
poses_imu/0000.txt           the same as rows of 12 numbers, relative to the first
label_02/0000.txt            boxes in the camera's view, with truncation and occlusion
detections/{noisy,perfect}/0000.txt   boxes in the camera's view in the format that AB3DMOT reads
)";

constexpr const char* kLayoutOdometry = R"(
sequences/00/velodyne/NNNNNN.bin  scans compensated for the robot's motion to the time at which the sensor looks
                                  ahead, rounded to 1 mm, elevations too low by the bias in synthetic.json,
                                  as KITTI odometry's
sequences/00/labels/NNNNNN.label  uint32 per point: SemanticKITTI class in the lower 16 bits, object id in the upper
                                  16; 10 car, 18 truck, 20 van and others, 30 person, 31 cyclist are movable and at
                                  rest, 252 to 259 are moving, all others are static
sequences/00/calib.txt, times.txt
poses/00.txt                      true poses of camera 0 relative to the first
)";

constexpr const char* kTruth = R"(
truth/poses_{start,stamp,end}.txt  lidar poses at the start of each sweep, when it looks ahead, and at its end:
                             rows of 12 numbers in the map frame, which is that of the lidar at the first stamp
truth/times.txt              of the stamps [s]
truth/objects.csv            all objects around at each stamp: pose, size and velocity in the map frame, upright box in
                             the lidar frame, number of returns, share of it that is visible
truth/static_map.ply         static surfaces that were seen, without noise, in the map frame; label 1 ground,
                             2 poles and trunks, 3 other surfaces, 0 leaves
detections/{noisy,perfect}.csv  boxes all round in the lidar frame: with a detector's errors (see synthetic.json),
                             and without any
)";

}  // namespace

std::string readme(const SimulationOptions& options) {
  const bool tracking = options.layout == Layout::tracking;
  return fmt::format(
      "SYNTHETIC DATA: everything in this folder was computed by 'mlo simulate' (version {}); nothing was "
      "measured.\n"
      "Scene '{}', {} m, seed {}, lidar {}. All options: synthetic.json. The same seed gives the same "
      "bytes.\n"
      "The layout is that of KITTI's {} benchmark; neither data nor calibration of KITTI were used.\n{}{}",
      options.version, name_of(options.scene.kind), options.scene.length_m, options.scene.seed,
      options.sensor.name, tracking ? "tracking" : "odometry", tracking ? kLayoutTracking : kLayoutOdometry,
      kTruth);
}

std::string provenance_json(const SimulationOptions& options) {
  const LidarErrors& lidar = options.errors;
  const DetectorErrors& detector = options.detector;
  const nlohmann::ordered_json json{
      {"synthetic", true},
      {"generator", "mlo simulate"},
      {"version", options.version},
      {"scene", name_of(options.scene.kind)},
      {"length_m", options.scene.length_m},
      {"seed", options.scene.seed},
      {"max_scans", options.max_scans},
      {"layout", options.layout == Layout::tracking ? "tracking" : "odometry"},
      {"map_voxel_m", options.map_voxel_m},
      {"sensor",
       {{"name", options.sensor.name},
        {"rings", options.sensor.elevations_deg().size()},
        {"columns", options.sensor.columns},
        {"rate_hz", options.sensor.rate_hz},
        {"min_range_m", options.sensor.min_range_m}}},
      {"lidar_errors",
       {{"range_noise_m", lidar.range_noise_m},
        {"max_range_m", lidar.max_range_m},
        {"random_loss", lidar.random_loss},
        {"loss_level", lidar.loss_level},
        {"elevation_bias_deg", lidar.elevation_bias_deg}}},
      {"detector_errors",
       {{"position_m", detector.position_m},
        {"position_per_m", detector.position_per_m},
        {"size_share", detector.size_share},
        {"yaw_rad", detector.yaw_rad},
        {"yaw_per_m", detector.yaw_per_m},
        {"flip_share", detector.flip_share},
        {"miss_share", detector.miss_share},
        {"half_points", detector.half_points},
        {"false_positives", detector.false_positives},
        {"score_noise", detector.score_noise},
        {"max_range_m", detector.max_range_m}}},
  };
  return json.dump(2) + "\n";
}

}  // namespace mlo::simulator
