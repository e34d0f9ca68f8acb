#include "mlo/reproduction/reproduce.hpp"

#include <fmt/format.h>

#include "mlo/evaluation/trajectory_error.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/reproduction/object_rows.hpp"
#include "mlo/reproduction/runs.hpp"
#include "mlo/reproduction/tracking_runs.hpp"
#include "mlo/truth/drive_truth.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

constexpr const char* kOdometry = "kitti_odometry";
constexpr const char* kTableOfEgoErrors[] = {"Table I", "Table II"};
constexpr const char* kTableOfObjects = "Table IV";

bool has_ego_errors(const PaperTable& table) {
  return table.name == kTableOfEgoErrors[0] || table.name == kTableOfEgoErrors[1];
}

// The paper judges raw drives by smoothed inertial records.
std::optional<PoseList> truth_of(const Dataset& dataset) {
  if (dataset.format == kOdometry) return dataset.truth;
  return smooth_drive(dataset).at_stamps.poses;
}

std::vector<std::optional<double>> ego_errors(const PoseList& truth, const fs::path& folder,
                                              std::size_t num_measures) {
  const PoseList estimate = read_trajectory(folder / "trajectory.txt");
  const TrajectoryErrors errors = trajectory_errors(match_poses(
      {truth.frames, {}, truth.T_world_body}, {estimate.frames, {}, estimate.T_world_body}, MatchBy::frame));
  std::vector<std::optional<double>> values{errors.ate_m, errors.rte_m_per_frame, errors.rre_deg_per_frame};
  values.resize(num_measures);
  return values;
}

ReproducedRow ego_row(const PaperTable& table, const PaperRow& row, const fs::path& sequence,
                      const ReproduceOptions& options, const ReproduceProgress& progress) {
  ReproducedRow result{.paper = row, .has_data = true, .here = {}, .note = {}};
  const Dataset dataset = open_dataset(sequence, {});
  const std::optional<PoseList> truth = truth_of(dataset);
  result.note = truth ? fmt::format("{} scans", scans_up_to(dataset, options.last_frame)) : "no true poses";
  for (const Variant& variant : variants_of(table)) {
    const fs::path folder = options.out / (table.data + "_" + row.name) / variant.name;
    progress.on_run(folder.string());
    if (!truth || !run_unless_finished(dataset, std::nullopt, variant, folder, options, progress)) {
      result.here.emplace_back(table.measures.size());
      continue;
    }
    result.here.push_back(ego_errors(*truth, folder, table.measures.size()));
  }
  return result;
}

ReproducedRow row_without_data(const PaperTable& table, const PaperRow& row) {
  ReproducedRow result{.paper = row, .has_data = false, .here = {}, .note = "data missing"};
  result.here.resize(variants_of(table).size());
  return result;
}

void ego_table(const KittiData& data, const ReproduceOptions& options, const ReproduceProgress& progress,
               ReproducedTable& result) {
  const PaperTable& table = result.paper;
  const auto& sequences = table.data == kOdometry ? data.odometry : data.raw;
  for (const Variant& variant : variants_of(table)) result.titles.push_back(variant.title);
  for (const PaperRow& row : table.rows) {
    if (progress.should_stop()) break;
    const auto found = sequences.find(row.name);
    if (found == sequences.end()) {
      result.missing.push_back(row.name);
      result.rows.push_back(row_without_data(table, row));
    } else {
      result.rows.push_back(ego_row(table, row, found->second, options, progress));
    }
  }
}

void tracking_table(const KittiData& data, const ReproduceProgress& progress, ReproducedTable& result) {
  result.titles = {"here, boxes alone, no poses"};
  const bool all = result.paper.rows.size() == 1 && result.paper.rows.front().name == "all";
  for (const PaperRow& row : result.paper.rows) {
    ReproducedRow reproduced{.paper = row, .has_data = true, .here = {{}}, .note = {}};
    progress.on_run("tracking " + row.name);
    const std::optional<TrackingRun> run = all ? track_ten_sequences(data) : track_sequence(data, row.name);
    if (!run) {
      reproduced.has_data = false;
      reproduced.note = "data missing (labels, calib and detections/pointrcnn_car)";
      result.missing.push_back(row.name);
    } else if (all) {
      reproduced.here = {{run->mota_percent, run->motp_percent, run->mean_ms}};
    } else {
      reproduced.here = {{run->largest_ms}};
    }
    result.rows.push_back(std::move(reproduced));
  }
}

}  // namespace

std::vector<Variant> variants_of(const PaperTable& table) {
  if (table.name == kTableOfObjects) {
    return {
        {.name = "geometry",
         .title = "here, geometry only",
         .presets = {},
         .settings = {"tracking.sgf.mode=geometry"}},
        {.name = "semantic",
         .title = "here, semantic only",
         .presets = {},
         .settings = {"tracking.sgf.mode=semantic"}},
        {.name = "fusion", .title = "here, fusion", .presets = {}, .settings = {"tracking.sgf.mode=fusion"}}};
  }
  if (!has_ego_errors(table)) return {};
  std::vector<Variant> variants{{.name = "paper",
                                 .title = "here, paper's method, camera's view",
                                 .presets = {"paper"},
                                 .settings = {"input.roi=camera"}}};
  if (table.name == kTableOfEgoErrors[1]) {
    variants.push_back({.name = "paper_gc",
                        .title = "here, MLO-gc",
                        .presets = {"paper"},
                        .settings = {"input.roi=camera", "odometry.consistency_check=false"}});
  }
  variants.push_back(
      {.name = "default", .title = "here, defaults, full scans", .presets = {}, .settings = {}});
  return variants;
}

ReproducedTable reproduce_table(const PaperTable& table, const KittiData& data,
                                const ReproduceOptions& options, const ReproduceProgress& progress) {
  ReproducedTable result{.paper = table, .titles = {}, .rows = {}, .missing = {}};
  if (has_ego_errors(table)) {
    ego_table(data, options, progress, result);
  } else if (table.data == "kitti_tracking") {
    tracking_table(data, progress, result);
  } else {
    for (const Variant& variant : variants_of(table)) result.titles.push_back(variant.title);
    for (const PaperRow& row : table.rows) {
      if (progress.should_stop()) break;
      result.rows.push_back(object_row(table, row, data, options, progress));
      if (!result.rows.back().has_data) result.missing.push_back(row.name);
    }
  }
  return result;
}

}  // namespace mlo
