#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include "apps/mlo/commands.hpp"
#include "apps/mlo/config_options.hpp"
#include "apps/mlo/progress.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/pipeline/find_objects.hpp"

namespace mlo::apps {
namespace {

struct Options {
  std::filesystem::path folder;
  OpenOptions open;
  std::filesystem::path out;
  std::filesystem::path candidates;
  std::filesystem::path poses;
  ConfigArguments config;
};

std::string candidate_header() {
  return fmt::format("frame,class,x_m,y_m,z_m,length_m,width_m,height_m,yaw_rad,{}\n",
                     fmt::join(kCandidateFeatures, ","));
}

std::string candidate_line(std::size_t frame, const Candidate& candidate) {
  const Eigen::Vector3d& p = candidate.box.center_lidar_m;
  const Eigen::Vector3d& size = candidate.box.size_lwh_m;
  return fmt::format("{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.4f},{:.5f}\n", frame,
                     to_string(candidate.object_class), p.x(), p.y(), p.z(), size.x(), size.y(), size.z(),
                     candidate.box.yaw_rad, fmt::join(candidate.features, ","));
}

/// Motion of the lidar between scans, where poses are given.
class Motion {
 public:
  explicit Motion(const std::filesystem::path& file) {
    if (file.empty()) return;
    const PoseList poses = read_trajectory(file);
    for (std::size_t i = 0; i < poses.frames.size(); ++i) {
      T_map_lidar_.emplace(poses.frames[i], poses.T_world_body[i]);
    }
  }
  std::optional<SE3> between(std::size_t now, std::size_t before) const {
    const auto pose_now = T_map_lidar_.find(now);
    const auto pose_before = T_map_lidar_.find(before);
    if (pose_now == T_map_lidar_.end() || pose_before == T_map_lidar_.end()) return std::nullopt;
    return pose_now->second.inverse() * pose_before->second;
  }

 private:
  std::map<std::size_t, SE3> T_map_lidar_;
};

void warn_of_problems(const Scan& scan, const PipelineConfig& config, const Network* network) {
  for (const std::string& problem : find_detector_problems(scan, config, network))
    spdlog::warn("{}", problem);
}

void run(const Options& options) {
  const Dataset dataset = open_dataset(options.folder, options.open);
  PipelineConfig base;
  base.sensor = dataset.sensor;
  const PipelineConfig config = resolve(options.config, base);
  std::string boxes = detection_csv_header();
  std::string candidates = candidate_header();
  const Motion motion(options.poses);
  const std::shared_ptr<const Network> network = load_network(config.detection);
  FoundObjects last;
  std::size_t last_frame = 0;
  std::size_t count = 0;
  std::size_t scans = 0;
  Progress progress("scans", dataset.scans->size());
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    const ScanReading reading = dataset.scans->read(i);
    progress.update(i + 1);
    if (!reading.scan) continue;
    ++scans;
    if (!options.out.empty()) {
      const std::size_t frame = reading.scan->frame;
      std::optional<FoundBefore> before;
      if (const auto T_now_before = motion.between(frame, last_frame)) before = {last.likely, *T_now_before};
      if (scans == 1) before.reset();
      if (scans == 1) warn_of_problems(*reading.scan, config, network.get());
      last = find_objects(*reading.scan, before, config, network.get());
      last_frame = frame;
      count += last.objects.size();
      boxes += detection_csv_lines(frame, last.objects);
    }
    if (options.candidates.empty()) continue;
    for (const Candidate& candidate : find_object_candidates(*reading.scan, config)) {
      candidates += candidate_line(reading.scan->frame, candidate);
    }
  }
  progress.finish();
  if (!options.out.empty()) {
    write_file_atomically(options.out, boxes);
    std::cout << fmt::format("{} boxes in {} of {} scans, in {}\n", count, scans, dataset.scans->size(),
                             options.out.string());
  }
  if (!options.candidates.empty()) write_file_atomically(options.candidates, candidates);
}

}  // namespace

void add_detect(CLI::App& program) {
  auto* command = program.add_subcommand("detect", "From scans to 3D boxes of objects");
  const auto options = std::make_shared<Options>();
  command->add_option("folder", options->folder, "KITTI odometry, raw or tracking data, or a folder of scans")
      ->required()
      ->type_name("FOLDER");
  auto* out = command->add_option("--out", options->out, "CSV to write the boxes to (docs/detections.md)")
                  ->type_name("FILE");
  auto* candidates =
      command
          ->add_option("--candidates", options->candidates,
                       "CSV to write all that the cluster detector judges to, with the features "
                       "that it judges by")
          ->type_name("FILE");
  command->add_option("--sequence", options->open.sequence, "Which one, where the folder holds several")
      ->type_name("N");
  command->add_option("--format", options->open.format, "Layout of the folder; found out by default")
      ->check(CLI::IsMember({"auto", "kitti_odometry", "kitti_raw", "kitti_tracking", "folder"}));
  command
      ->add_option(
          "--poses", options->poses,
          "poses of the lidar (KITTI or TUM rows), as a run's trajectory.txt: what was seen in the scan "
          "before then tells what is sure in the next, as in mlo run")
      ->type_name("FILE");
  add_config_options(*command, options->config);
  command->footer(R"(
The detector is that of the configuration (detection.detector); mlo run uses the same where no boxes are given.

Examples:
  mlo detect kitti_raw/2011_09_26/2011_09_26_drive_0005_sync --out boxes.csv
  mlo detect my_scans --poses out/mine/trajectory.txt --out boxes.csv
  mlo detect city --out boxes.csv --set detection.cluster.min_probability=0.05
  mlo eval detection --truth city/truth/objects.csv --truth-poses city/truth/poses_stamp.txt --estimate boxes.csv)");
  command->callback([options, out, candidates] {
    if (!*out && !*candidates) throw CLI::RequiredError("--out");
    run(*options);
  });
}

}  // namespace mlo::apps
