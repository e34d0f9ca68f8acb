#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/eval.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/detection_ap.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/truth/detection_truth.hpp"

namespace mlo::apps {
namespace {

using nlohmann::ordered_json;

constexpr const char* kExplanation = R"(
AP is KITTI's average precision at 40 recall points, of boxes in space (3D) and seen from above (BEV). The truth is KITTI
tracking labels (with --calib; what the image does not show is left out), or objects.csv with the poses of the lidar (all
round). Several sequences are scored as one: give --truth, --estimate and, where needed, --truth-poses and --calib once for each.

Examples:
  mlo eval detection --truth label_02/0000.txt --calib calib/0000.txt --estimate pointrcnn_car
  mlo eval detection --truth city/truth/objects.csv --truth-poses city/truth/poses_stamp.txt --estimate boxes.csv
  mlo eval detection --truth city/truth/objects.csv --truth-poses city/truth/poses_stamp.txt --estimate boxes.csv \
    --class pedestrian --iou 0.25 0.5 --json)";

struct Options {
  std::vector<std::filesystem::path> truth;
  std::vector<std::filesystem::path> truth_poses;
  std::vector<std::filesystem::path> calibration;
  std::vector<std::filesystem::path> estimate;
  std::vector<std::string> classes = {"car"};
  std::vector<double> min_overlaps = {0.5, 0.7};
  std::vector<double> range_borders_m = {0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 70.0};
  std::vector<double> image_size_px = {1242.0, 375.0};
  double min_confidence = 0.0;
  bool json = false;
};

/// The i-th of the paths.
std::filesystem::path at(const std::vector<std::filesystem::path>& paths, std::size_t i, const char* option,
                         const std::filesystem::path& truth) {
  if (i < paths.size()) return paths[i];
  throw InputError(
      fmt::format("{}: has no {}; give one for each --truth, in the same order", truth.string(), option));
}

DetectionList detections_by_frame(const std::filesystem::path& path, const Calibration& calibration,
                                  const std::string& sequence) {
  DetectionList detections = read_detections({path}, calibration, {.sequence = sequence});
  if (detections.by_stamp_s.empty()) return detections;
  throw InputError(fmt::format("{}: its boxes are by stamp_s; a column 'frame' is needed", path.string()));
}

std::vector<DetectionFrame> load_labels(const Options& options, std::size_t i) {
  const std::filesystem::path& truth = options.truth[i];
  const std::filesystem::path calibration_file = at(options.calibration, i, "--calib", truth);
  const Calibration calibration = read_calibration_file(calibration_file);
  if (!calibration.P2 || !calibration.T_camera0_lidar) {
    throw InputError(fmt::format("{}: holds no P2 or no place of the lidar relative to the camera",
                                 calibration_file.string()));
  }
  const LabelledView view{
      *calibration.T_camera0_lidar, *calibration.P2, {options.image_size_px[0], options.image_size_px[1]}};
  const DetectionList detections =
      detections_by_frame(at(options.estimate, i, "--estimate", truth), calibration, truth.stem().string());
  return detection_frames(labelled_boxes(read_kitti_tracks(truth), view.T_camera0_lidar), detections, view);
}

std::vector<DetectionFrame> load_objects(const Options& options, std::size_t i) {
  const std::filesystem::path& truth = options.truth[i];
  const PoseList poses = read_trajectory(at(options.truth_poses, i, "--truth-poses", truth));
  const DetectionList detections = detections_by_frame(at(options.estimate, i, "--estimate", truth), {}, "");
  return detection_frames(labelled_boxes(read_objects_csv(truth), poses), detections, std::nullopt);
}

std::vector<DetectionFrame> load(const Options& options) {
  std::vector<DetectionFrame> frames;
  for (std::size_t i = 0; i < options.truth.size(); ++i) {
    const bool is_labels = options.truth[i].extension() == ".txt";
    const auto sequence = is_labels ? load_labels(options, i) : load_objects(options, i);
    frames.insert(frames.end(), sequence.begin(), sequence.end());
  }
  return frames;
}

/// One row of the result.
struct Scores {
  DetectionProtocol protocol;
  std::array<AveragePrecision, kDifficulties.size()> by_difficulty;
  std::vector<RangeRecall> by_range;
};

std::vector<Scores> evaluate(const std::vector<DetectionFrame>& frames, const Options& options) {
  std::vector<Scores> all;
  for (const std::string& object_class : options.classes) {
    for (const BoxOverlap overlap : {BoxOverlap::footprint, BoxOverlap::volume}) {
      for (const double min_overlap : options.min_overlaps) {
        Scores scores;
        scores.protocol = {object_class, overlap, min_overlap};
        for (std::size_t i = 0; i < kDifficulties.size(); ++i) {
          scores.by_difficulty[i] = average_precision(frames, scores.protocol, kDifficulties[i]);
        }
        scores.by_range = recall_by_range(frames, scores.protocol, Difficulty::hard, options.range_borders_m,
                                          options.min_confidence);
        all.push_back(std::move(scores));
      }
    }
  }
  return all;
}

std::string name_of(BoxOverlap overlap) {
  return overlap == BoxOverlap::volume ? "3D" : "BEV";
}

void print_table(const std::vector<Scores>& all, std::size_t num_frames) {
  fmt::print("{} frames; AP at 40 recall points, recall of hard truth by range, in per cent\n\n", num_frames);
  fmt::print("{:<11} {:<4} {:>4} {:>6} {:>8} {:>6}  ", "class", "box", "IoU", "easy", "moderate", "hard");
  for (const RangeRecall& bin : all.front().by_range) {
    fmt::print(" {:>7}", fmt::format("{:g}-{:g}m", bin.from_m, bin.to_m));
  }
  fmt::print("\n");
  for (const Scores& scores : all) {
    fmt::print("{:<11} {:<4} {:>4g} {:>6.2f} {:>8.2f} {:>6.2f}  ", scores.protocol.object_class,
               name_of(scores.protocol.overlap), scores.protocol.min_overlap,
               100.0 * scores.by_difficulty[0].ap, 100.0 * scores.by_difficulty[1].ap,
               100.0 * scores.by_difficulty[2].ap);
    for (const RangeRecall& bin : scores.by_range) {
      const double share = 100.0 * static_cast<double>(bin.found) / static_cast<double>(bin.truth);
      fmt::print(" {:>7}", bin.truth == 0 ? "-" : fmt::format("{:.1f}", share));
    }
    fmt::print("   of {}, {}, {}\n", scores.by_difficulty[0].num_truth, scores.by_difficulty[1].num_truth,
               scores.by_difficulty[2].num_truth);
  }
}

ordered_json json_of(const Scores& scores) {
  constexpr std::array kNames{"easy", "moderate", "hard"};
  ordered_json row{{"class", scores.protocol.object_class},
                   {"box", name_of(scores.protocol.overlap)},
                   {"iou", scores.protocol.min_overlap}};
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    const AveragePrecision& ap = scores.by_difficulty[i];
    row[kNames[i]] = {
        {"ap", ap.ap}, {"truth", ap.num_truth}, {"recall", ap.recall}, {"precision", ap.precision}};
  }
  row["recall_by_range"] = ordered_json::array();
  for (const RangeRecall& bin : scores.by_range) {
    row["recall_by_range"].push_back(
        {{"from_m", bin.from_m}, {"to_m", bin.to_m}, {"truth", bin.truth}, {"found", bin.found}});
  }
  return row;
}

void run(const Options& options) {
  const std::vector<DetectionFrame> frames = load(options);
  const std::vector<Scores> all = evaluate(frames, options);
  if (options.json) {
    ordered_json rows = ordered_json::array();
    for (const Scores& scores : all) rows.push_back(json_of(scores));
    fmt::print("{}\n", rows.dump(2));
  } else {
    print_table(all, frames.size());
  }
}

void add_inputs(CLI::App& command, Options& options) {
  command.add_option("--truth", options.truth, "KITTI tracking labels (.txt), or objects.csv")->required();
  command.add_option("--estimate", options.estimate, "boxes, in any format that mlo run takes")->required();
  command.add_option("--truth-poses", options.truth_poses,
                     "poses of the lidar that objects.csv goes with: KITTI or TUM rows");
  command.add_option("--calib", options.calibration, "calibration of KITTI's labels");
  command
      .add_option("--image-size", options.image_size_px,
                  "with labels, boxes outside of the image are left out: width height [px]")
      ->expected(2)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
}

}  // namespace

void add_eval_detection(CLI::App& eval) {
  CLI::App* command = eval.add_subcommand("detection", "Average precision of a detector's 3D boxes");
  const auto options = std::make_shared<Options>();
  add_inputs(*command, *options);
  command->add_option("--class", options->classes, "what to score")
      ->check(CLI::IsMember({"car", "van", "truck", "pedestrian", "cyclist"}))
      ->capture_default_str();
  command->add_option("--iou", options->min_overlaps, "a match overlaps more than this")
      ->check(CLI::Range(0.01, 1.0))
      ->capture_default_str();
  command->add_option("--ranges", options->range_borders_m, "borders of the recall by range [m]")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command
      ->add_option("--min-confidence", options->min_confidence,
                   "recall by range counts detections with at least this score")
      ->capture_default_str();
  command->add_flag("--json", options->json, "print JSON, shares and not per cent");
  command->footer(kExplanation);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
