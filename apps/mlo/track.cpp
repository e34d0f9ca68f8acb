#include <algorithm>
#include <chrono>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/config_options.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/pipeline/track_detections.hpp"

namespace mlo::apps {
namespace {

namespace fs = std::filesystem;

constexpr const char* kExplanation = R"(
Every frame's tracks depend on it and earlier frames only. Without --poses, the lidar's motion is estimated from the boxes.

Writes to DIR: tracks/NNNN.txt (KITTI tracking results, where --calib has a camera), objects/NNNN.csv (pose, velocity,
turn rate, uncertainty, size of every reported object in every frame) and trajectories/NNNN/ID.txt (TUM rows).

Examples:
  mlo track --detections detections/pointrcnn_car --poses poses_imu --calib calib --out out/tracks
  mlo track --detections detections/pointrcnn_car detections/pointrcnn_cyclist --calib calib --sequences 0000 --out out/0000
  mlo track --detections boxes.csv --out out/mine --set tracking.lifecycle.max_coasting=2
  mlo eval tracking --truth label_02 --estimate out/tracks/tracks)";

struct Options {
  std::vector<fs::path> detections;
  fs::path poses;
  std::string poses_of = "imu";
  fs::path calibration;
  fs::path out;
  std::vector<std::string> sequences;
  std::vector<double> image_size_px = {1242.0, 375.0};
  double rate_hz = 10.0;
  ConfigArguments config;
};

// The sequences that the first of the folders has a file of; a single file is a sequence by its name.
std::vector<std::string> sequence_names(const Options& options) {
  if (!options.sequences.empty()) return options.sequences;
  const fs::path& first = options.detections.front();
  if (!fs::is_directory(first)) return {first.stem().string()};
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(first)) {
    if (entry.path().extension() == ".txt") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  if (names.empty()) {
    throw InputError(fmt::format("{}: holds no .txt files; expected one per sequence", first.string()));
  }
  return names;
}

// A folder has a file for each sequence; a file is meant as it is.
fs::path file_of(const fs::path& path, const std::string& sequence) {
  return fs::is_directory(path) ? path / (sequence + ".txt") : path;
}

std::optional<PoseList> lidar_poses(const Options& options, const std::string& sequence,
                                    const Calibration& calibration) {
  if (options.poses.empty()) return std::nullopt;
  PoseList poses = read_kitti_poses(file_of(options.poses, sequence));
  if (options.poses_of == "lidar") return poses;
  const std::optional<SE3>& T_pose_lidar =
      options.poses_of == "imu" ? calibration.T_imu_lidar : calibration.T_camera0_lidar;
  if (!T_pose_lidar) {
    throw InputError(
        fmt::format("{}: poses of the {} need its calibration to the lidar; give --calib, or poses of the "
                    "lidar with --poses-of lidar",
                    options.poses.string(), options.poses_of));
  }
  return rebased(std::move(poses), *T_pose_lidar);
}

std::optional<CameraView> camera_view(const Options& options, const Calibration& calibration) {
  if (!calibration.T_camera0_lidar || !calibration.P2) return std::nullopt;
  return CameraView{
      *calibration.T_camera0_lidar, *calibration.P2, {options.image_size_px[0], options.image_size_px[1]}};
}

struct SequenceSummary {
  std::size_t frames = 0;
  std::size_t boxes = 0;
  double seconds = 0.0;
};

SequenceSummary track_sequence(const Options& options, const std::string& sequence, TrackingConfig config) {
  Calibration calibration;
  if (!options.calibration.empty())
    calibration = read_calibration_file(file_of(options.calibration, sequence));
  const DetectionList detections = read_detections(options.detections, calibration, {.sequence = sequence});
  const std::optional<PoseList> poses = lidar_poses(options, sequence, calibration);
  const std::optional<CameraView> view = camera_view(options, calibration);
  if (view)
    config.lifecycle.field_of_view_deg = std::min(config.lifecycle.field_of_view_deg, view->width_deg());

  const auto start = std::chrono::steady_clock::now();
  const std::vector<FrameTracks> frames = track_detections(detections, poses, 1.0 / options.rate_hz, config);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;

  for (const char* name : {"tracks", "objects"}) fs::create_directories(options.out / name);
  if (view) write_kitti_tracks(options.out / "tracks" / (sequence + ".txt"), kitti_records(frames, *view));
  write_object_table(options.out / "objects" / (sequence + ".csv"), frames);
  write_object_trajectories(options.out / "trajectories" / sequence, frames);
  return {frames.size(), detections.count(), seconds.count()};
}

void run(const Options& options) {
  const TrackingConfig config = resolve(options.config).tracking;
  SequenceSummary all;
  const std::vector<std::string> names = sequence_names(options);
  for (const std::string& sequence : names) {
    const SequenceSummary one = track_sequence(options, sequence, config);
    all.frames += one.frames;
    all.boxes += one.boxes;
    all.seconds += one.seconds;
  }
  std::cout << fmt::format("{} sequences, {} frames, {} boxes, {:.0f} frames per second; results in {}\n",
                           names.size(), all.frames, all.boxes,
                           static_cast<double>(all.frames) / std::max(all.seconds, 1e-9),
                           options.out.string());
}

}  // namespace

void add_track(CLI::App& program) {
  auto* command =
      program.add_subcommand("track", "From boxes of a detector, with or without poses, to tracks");
  const auto options = std::make_shared<Options>();
  command
      ->add_option(
          "--detections", options->detections,
          "3D boxes (docs/detections.md): a file, or folders with a file per sequence, one folder per class")
      ->required()
      ->type_name("PATH");
  command
      ->add_option("--poses", options->poses,
                   "KITTI rows, a row per frame: a file, or a folder with one per sequence")
      ->type_name("PATH");
  command->add_option("--poses-of", options->poses_of, "The body whose poses these are")
      ->check(CLI::IsMember({"imu", "lidar", "camera"}))
      ->capture_default_str();
  command
      ->add_option("--calib", options->calibration,
                   "KITTI calibration: a file, or a folder with one per sequence")
      ->type_name("PATH");
  command->add_option("--out", options->out, "Folder for the results; made if missing")
      ->required()
      ->type_name("DIR");
  command->add_option("--sequences", options->sequences,
                      "Names of the sequences (default: all that have detections)");
  command->add_option("--image-size", options->image_size_px, "Width and height of the camera's images [px]")
      ->expected(2)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--rate", options->rate_hz, "Scans per second [Hz]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  add_config_options(*command, options->config);
  command->footer(kExplanation);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
