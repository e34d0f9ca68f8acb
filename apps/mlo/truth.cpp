#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <string>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/progress.hpp"
#include "mlo/core/error.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/truth/drive_check.hpp"
#include "mlo/truth/drive_truth.hpp"
#include "mlo/truth/object_truth.hpp"

namespace mlo::apps {
namespace {

struct Options {
  std::filesystem::path folder;
  OpenOptions open;
  std::filesystem::path out;
  OxtsSmootherOptions smoother;
  bool check = false;
};

void write(const Options& options, const DriveTruth& truth, const std::vector<ObjectPose>& objects) {
  std::filesystem::create_directories(options.out);
  write_kitti_poses(options.out / "poses.txt", truth.at_stamps.poses);
  write_tum_poses(options.out / "poses_tum.txt", truth.at_stamps.poses);
  write_covariances(options.out / "covariance.csv", truth.at_stamps);
  write_kitti_poses(options.out / "poses_middle.txt", truth.at_middle.poses);
  write_tum_poses(options.out / "poses_middle_tum.txt", truth.at_middle.poses);
  write_covariances(options.out / "covariance_middle.csv", truth.at_middle);
  if (!objects.empty()) write_objects_csv(options.out / "objects.csv", objects);
}

std::string millimetres(const std::optional<double>& value_m) {
  return value_m ? fmt::format("{:.1f}", 1000.0 * *value_m) : "-";
}

// Residuals of static surfaces, raw records beside smoothed ones.
void print_check(const Dataset& dataset, const DriveTruth& truth) {
  std::cout << fmt::format(
      "\npoints of a scan from the planes of an earlier one [mm]\n{:>6} {:<9} {:>8} {:>8} {:>10}\n", "scans",
      "poses", "median", "mean", "residuals");
  for (const std::size_t lag : {1U, 5U, 10U}) {
    for (const auto& [name, poses] : {std::pair<const char*, const PoseList&>{"raw", *dataset.truth},
                                      {"smoothed", truth.at_stamps.poses}}) {
      const DriveConsistency consistency = check_drive(dataset, poses, lag);
      std::cout << fmt::format("{:>6} {:<9} {:>8} {:>8} {:>10}\n", lag, name,
                               millimetres(consistency.median_m), millimetres(consistency.mean_m),
                               consistency.residuals);
    }
  }
}

void run(const Options& options) {
  const Dataset dataset = open_dataset(options.folder, options.open);
  const DriveTruth truth = smooth_drive(dataset, options.smoother);
  const std::vector<ObjectPose> objects = objects_in_map(annotated_boxes(dataset), truth.at_stamps.poses);
  write(options, truth, objects);
  std::cout << fmt::format("{}: {} poses, {} poses of objects; results in {}: poses.txt, covariance.csv{}\n",
                           dataset.sequence, truth.at_stamps.poses.frames.size(), objects.size(),
                           options.out.string(), objects.empty() ? "" : ", objects.csv");
  if (options.check && dataset.truth) print_check(dataset, truth);
}

}  // namespace

void add_truth(CLI::App& program) {
  auto* command =
      program.add_subcommand("truth", "Smoothed ground truth of a drive from its inertial records");
  const auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "KITTI raw drive, or KITTI tracking data with oxts")
      ->required()
      ->type_name("FOLDER");
  command->add_option("--out", options->out, "Folder for the results; made if missing")
      ->required()
      ->type_name("DIR");
  command->add_option("--sequence", options->open.sequence, "Which one, where the folder holds several")
      ->type_name("N");
  const auto positive = [&](const char* name, double& value, const char* meaning) {
    command->add_option(name, value, meaning)->check(CLI::PositiveNumber)->capture_default_str();
  };
  OxtsSmootherOptions& smoother = options->smoother;
  positive("--roll-pitch-noise", smoother.roll_pitch_deg,
           "Standard deviation of the records' roll and pitch [deg]");
  positive("--heading-noise", smoother.heading_deg, "Of their heading [deg]");
  positive("--rate-noise", smoother.rate_deg_s, "Of their angular rates [deg/s]");
  positive("--acceleration-walk", smoother.acceleration_walk_m_s2,
           "How much the acceleration wanders: less smooths more [m/s^2 per sqrt(s)]");
  positive("--rate-walk", smoother.rate_walk_deg_s, "The same of the angular rate [deg/s per sqrt(s)]");
  command->add_flag("--check", options->check,
                    "Print how well scans agree by the raw and by the smoothed poses; reads all scans");
  command->footer(R"(
Writes to DIR: poses.txt (KITTI rows, lidar poses at the scans' stamps in the first scan's frame), poses_tum.txt,
covariance.csv, the same at the middle of each sweep (poses_middle*.txt, covariance_middle.csv), and objects.csv where the
data has labels or tracklets. An extended Kalman filter and a smoother take place, velocity and attitude with the records'
own accuracies; see docs/evaluation.md.

Examples:
  mlo truth kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --out truth/0005
  mlo truth kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --out truth/0005 --check
  mlo truth kitti_tracking/training --sequence 0000 --out truth/0000)");
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
