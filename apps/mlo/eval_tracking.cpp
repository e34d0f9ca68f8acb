#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "apps/mlo/eval.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/tracking_evaluation.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/kitti_tracks.hpp"

namespace mlo::apps {
namespace {

constexpr const char* kExplanation =
    R"(HOTA, DetA, AssA, LocA, MOTA, MOTP, IDSW, Frag, MT, PT, ML, FP, FN and IDF1 follow TrackEval's KITTI protocol. The lines
'KITTI kit' count as the older development kit does, for comparison with older papers; sAMOTA, AMOTA and AMOTP are AB3DMOT's
means over recall, counted likewise. Vans for cars, sitting persons for pedestrians, DontCare regions, truncated and
heavily occluded objects are neither demanded nor held against a track. With --calib, tracks without image boxes get the
rectangle around their projected 3D box. Measures in per cent, others are counts.

Examples:
  mlo eval tracking --truth training/label_02 --estimate out/tracks
  mlo eval tracking --truth training/label_02 --estimate out/tracks --class car pedestrian --sequences 0000 0002 --json
  mlo eval tracking --truth training/label_02 --estimate out/tracks --calib training/calib
  mlo eval tracking --truth label_02/0000.txt --estimate out/0000.txt --match box --threshold 0.25
)";

struct Options {
  std::filesystem::path truth;
  std::filesystem::path estimate;
  std::filesystem::path calibration;
  std::vector<double> image_size_px = {1242.0, 375.0};
  std::vector<std::string> classes = {"car"};
  std::vector<std::string> sequences;
  std::vector<std::string> match = {"image", "box", "distance"};
  std::vector<double> thresholds;
  double max_distance_m = TrackingProtocol{}.max_distance_m;
  bool per_sequence = false;
  bool json = false;
};

using Sequences = std::map<std::string, std::vector<ObjectRecord>>;

std::vector<ObjectRecord> records_of(const Sequences& sequences, const std::string& name,
                                     const std::filesystem::path& folder) {
  const auto found = sequences.find(name);
  if (found != sequences.end()) return found->second;
  throw InputError(
      fmt::format("{}: no file {}.txt; give the sequences to score with --sequences", folder.string(), name));
}

void require_image_boxes(const std::vector<ObjectRecord>& records, const std::string& name,
                         const std::filesystem::path& path) {
  for (const ObjectRecord& record : records) {
    if (record.has_image_box()) continue;
    throw InputError(
        fmt::format("{}, sequence {}: track {} has no image box in frame {}; the protocol needs them to "
                    "leave out small and DontCare objects: write them with the tracks, or give the "
                    "calibration with --calib, to project the 3D boxes",
                    path.string(), name, record.track_id, record.frame));
  }
}

// What lies outside the image keeps an empty box, which the protocol excuses.
void project_boxes(std::vector<ObjectRecord>& records, const std::string& name, const Options& options) {
  const std::filesystem::path file =
      is_directory(options.calibration) ? options.calibration / (name + ".txt") : options.calibration;
  const Calibration calibration = read_calibration_file(file);
  if (!calibration.P2) throw InputError(fmt::format("{}: holds no P2, the camera's matrix", file.string()));
  const Eigen::Vector2d size_px(options.image_size_px[0], options.image_size_px[1]);
  for (ObjectRecord& record : records) {
    if (record.has_image_box()) continue;
    record.image_box = project_box(kitti_box_of(record), *calibration.P2, size_px).value_or(Box2d{});
  }
}

std::vector<SequenceRecords> load(const Options& options) {
  const Sequences truth = read_kitti_sequences(options.truth);
  const Sequences tracks = read_kitti_sequences(options.estimate);
  std::vector<std::string> names = options.sequences;
  if (names.empty()) {
    for (const auto& [name, records] : truth) names.push_back(name);
  }
  const bool single_files = !is_directory(options.truth) && !is_directory(options.estimate);
  std::vector<SequenceRecords> sequences;
  for (const std::string& name : names) {
    sequences.push_back(
        {.name = name,
         .truth = records_of(truth, name, options.truth),
         .tracks = single_files ? tracks.begin()->second : records_of(tracks, name, options.estimate)});
    if (options.calibration.empty()) {
      require_image_boxes(sequences.back().tracks, name, options.estimate);
    } else {
      project_boxes(sequences.back().tracks, name, options);
    }
  }
  return sequences;
}

std::vector<TrackingProtocol> protocols(const Options& options) {
  std::vector<TrackingProtocol> all;
  for (const std::string& object_class : options.classes) {
    for (const std::string& match : options.match) {
      TrackingProtocol protocol{.object_class = object_class, .max_distance_m = options.max_distance_m};
      std::vector<double> thresholds = {0.5};
      if (match == "image") protocol.similarity = Similarity::image_iou;
      if (match == "distance") protocol.similarity = Similarity::center_distance;
      if (match == "box") {
        protocol.similarity = Similarity::box_iou;
        thresholds = {0.25, 0.5, 0.7};
      }
      if (!options.thresholds.empty() && match != "distance") thresholds = options.thresholds;
      for (const double threshold : thresholds) {
        protocol.match_threshold = threshold;
        all.push_back(protocol);
      }
    }
  }
  return all;
}

std::string description(const TrackingProtocol& protocol) {
  switch (protocol.similarity) {
    case Similarity::image_iou:
      return fmt::format("2D boxes in the image, IoU {:g}", protocol.match_threshold);
    case Similarity::box_iou:
      return fmt::format("3D boxes, IoU {:g}", protocol.match_threshold);
    case Similarity::center_distance:
      break;
  }
  return fmt::format("3D centres, at most {:g} m apart", protocol.max_distance_m);
}

void print_row(const std::string& name, const TrackingScores& scores) {
  const ClearMot& clear = scores.clear;
  fmt::print(
      "{:<10} {:>6.2f} {:>6.2f} {:>6.2f} {:>6.2f} {:>7.2f} {:>6.2f} {:>5} {:>5} {:>4} {:>4} {:>4} {:>6} "
      "{:>6} {:>6.2f}\n",
      name, 100.0 * scores.hota.hota(), 100.0 * scores.hota.det_a(), 100.0 * scores.hota.ass_a(),
      100.0 * scores.hota.loc_a(), 100.0 * clear.mota(), 100.0 * clear.motp(), clear.id_switches,
      clear.fragments, clear.mostly_tracked, clear.partly_tracked, clear.mostly_lost, clear.false_positives,
      clear.false_negatives, 100.0 * scores.identity.f1());
}

void print_table(const TrackingEvaluation& evaluation, bool per_sequence) {
  fmt::print("{}: {}\n", evaluation.protocol.object_class, description(evaluation.protocol));
  fmt::print("{:<10} {:>6} {:>6} {:>6} {:>6} {:>7} {:>6} {:>5} {:>5} {:>4} {:>4} {:>4} {:>6} {:>6} {:>6}\n",
             "TrackEval", "HOTA", "DetA", "AssA", "LocA", "MOTA", "MOTP", "IDSW", "Frag", "MT", "PT", "ML",
             "FP", "FN", "IDF1");
  for (std::size_t i = 0; per_sequence && i < evaluation.sequences.size(); ++i) {
    print_row(evaluation.names[i], evaluation.sequences[i]);
  }
  print_row("all", evaluation.all);
  const KitCounts& kit = evaluation.all.kit;
  fmt::print("KITTI kit: MOTA {:.2f} MOTP {:.2f} IDSW {} Frag {} MT {} PT {} ML {} FP {} FN {}\n",
             100.0 * kit.mota(), 100.0 * kit.motp(), kit.id_switches, kit.fragments, kit.mostly_tracked,
             kit.partly_tracked, kit.mostly_lost, kit.false_positives, kit.false_negatives);
  fmt::print("AB3DMOT: sAMOTA {:.2f} AMOTA {:.2f} AMOTP {:.2f}; best MOTA {:.2f}\n\n",
             100.0 * evaluation.averaged.samota, 100.0 * evaluation.averaged.amota,
             100.0 * evaluation.averaged.amotp, 100.0 * evaluation.averaged.best_mota);
}

nlohmann::ordered_json json_of(const TrackingScores& scores) {
  const ClearMot& clear = scores.clear;
  const KitCounts& kit = scores.kit;
  return {{"hota", scores.hota.hota()},
          {"det_a", scores.hota.det_a()},
          {"ass_a", scores.hota.ass_a()},
          {"loc_a", scores.hota.loc_a()},
          {"det_re", scores.hota.det_re()},
          {"det_pr", scores.hota.det_pr()},
          {"ass_re", scores.hota.ass_re()},
          {"ass_pr", scores.hota.ass_pr()},
          {"mota", clear.mota()},
          {"motp", clear.motp()},
          {"id_switches", clear.id_switches},
          {"fragments", clear.fragments},
          {"mostly_tracked", clear.mostly_tracked},
          {"partly_tracked", clear.partly_tracked},
          {"mostly_lost", clear.mostly_lost},
          {"true_positives", clear.true_positives},
          {"false_positives", clear.false_positives},
          {"false_negatives", clear.false_negatives},
          {"idf1", scores.identity.f1()},
          {"id_recall", scores.identity.recall()},
          {"id_precision", scores.identity.precision()},
          {"kitti_kit",
           {{"mota", kit.mota()},
            {"motp", kit.motp()},
            {"id_switches", kit.id_switches},
            {"fragments", kit.fragments},
            {"mostly_tracked", kit.mostly_tracked},
            {"partly_tracked", kit.partly_tracked},
            {"mostly_lost", kit.mostly_lost},
            {"true_positives", kit.true_positives},
            {"false_positives", kit.false_positives},
            {"false_negatives", kit.false_negatives}}}};
}

nlohmann::ordered_json json_of(const TrackingEvaluation& evaluation) {
  nlohmann::ordered_json sequences = nlohmann::ordered_json::object();
  for (std::size_t i = 0; i < evaluation.sequences.size(); ++i) {
    sequences[evaluation.names[i]] = json_of(evaluation.sequences[i]);
  }
  return {{"class", evaluation.protocol.object_class},
          {"match", description(evaluation.protocol)},
          {"protocol", "TrackEval KITTI; kitti_kit as the older KITTI development kit; averaged as AB3DMOT"},
          {"all", json_of(evaluation.all)},
          {"averaged",
           {{"samota", evaluation.averaged.samota},
            {"amota", evaluation.averaged.amota},
            {"amotp", evaluation.averaged.amotp},
            {"best_mota", evaluation.averaged.best_mota}}},
          {"sequences", std::move(sequences)}};
}

void run(const Options& options) {
  const std::vector<SequenceRecords> sequences = load(options);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const TrackingProtocol& protocol : protocols(options)) {
    const TrackingEvaluation evaluation = evaluate_tracking(sequences, protocol);
    if (options.json) {
      json.push_back(json_of(evaluation));
    } else {
      print_table(evaluation, options.per_sequence);
    }
  }
  if (options.json) fmt::print("{}\n", json.dump(2));
}

}  // namespace

void add_eval_tracking(CLI::App& eval) {
  CLI::App* command =
      eval.add_subcommand("tracking", "Multi-object tracking measures (HOTA, CLEAR MOT, IDF1, sAMOTA)");
  const auto options = std::make_shared<Options>();
  command->add_option("--truth", options->truth, "KITTI tracking label file, or folder with one per sequence")
      ->required();
  command
      ->add_option("--estimate", options->estimate,
                   "KITTI tracking result file, or folder with one per sequence")
      ->required();
  command->add_option(
      "--calib", options->calibration,
      "KITTI tracking calibration file, or folder with one per sequence: projects the 3D boxes of "
      "tracks without image boxes");
  command->add_option("--image-size", options->image_size_px, "clips projected boxes: width height [px]")
      ->expected(2)
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--class", options->classes, "what to score, as named in the files")
      ->check(CLI::IsMember({"car", "van", "truck", "pedestrian", "cyclist"}))
      ->capture_default_str();
  command->add_option("--sequences", options->sequences,
                      "names of the sequences (default: all of the truth)");
  command->add_option("--match", options->match, "what makes boxes alike")
      ->check(CLI::IsMember({"image", "box", "distance"}))
      ->capture_default_str();
  command
      ->add_option("--threshold", options->thresholds,
                   "least IoU of a match (default: image 0.5; box 0.25, 0.5, 0.7)")
      ->check(CLI::Range(0.01, 1.0));
  command->add_option("--max-distance", options->max_distance_m, "largest distance of matched centres [m]")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_flag("--per-sequence", options->per_sequence, "print a row for every sequence");
  command->add_flag("--json", options->json,
                    "print JSON, with all sequences, not a table; shares, not per cent");
  command->footer(kExplanation);
  command->callback([options] { run(*options); });
}

}  // namespace mlo::apps
