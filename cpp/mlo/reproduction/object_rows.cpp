#include "mlo/reproduction/object_rows.hpp"

#include <algorithm>
#include <span>

#include <fmt/format.h>

#include "mlo/evaluation/object_trajectories.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/reproduction/runs.hpp"
#include "mlo/truth/drive_truth.hpp"
#include "mlo/truth/object_truth.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

struct ObjectName {
  std::string drive;
  long id = 0;
};

ObjectName parse_name(const std::string& row) {
  const std::size_t space = row.find(' ');
  return {.drive = row.substr(0, space), .id = std::stol(row.substr(space + 1))};
}

// Boxes of the drive, published under the name of its tracking sequence.
std::optional<fs::path> car_detections_of(const KittiData& data, const std::string& drive) {
  const std::optional<std::string> sequence = tracking_sequence_of(drive);
  if (!sequence || !data.car_detections) return std::nullopt;
  const fs::path file = *data.car_detections / (*sequence + ".txt");
  return fs::exists(file) ? std::optional(file) : std::nullopt;
}

std::vector<ObjectBox> annotations_of(const KittiData& data, const Dataset& dataset,
                                      const std::string& drive) {
  std::vector<ObjectBox> boxes = annotated_boxes(dataset);
  const std::optional<std::string> sequence = tracking_sequence_of(drive);
  if (!boxes.empty() || !sequence || !data.labels || !dataset.calibration.T_camera0_lidar) return boxes;
  const fs::path labels = *data.labels / (*sequence + ".txt");
  if (!fs::exists(labels)) return {};
  return boxes_in_lidar(read_kitti_tracks(labels), *dataset.calibration.T_camera0_lidar);
}

std::vector<std::optional<double>> object_errors(std::span<const ObjectPose> truth, long id,
                                                 const fs::path& folder) {
  const ObjectEvaluation found = evaluate_objects(truth, read_objects_csv(folder / "objects.csv"));
  const auto object = std::ranges::find(found.objects, id, &ObjectErrors::truth_id);
  if (object == found.objects.end()) return {3, std::nullopt};
  return {object->ate_m, object->rte_m_per_m, object->rre_deg_per_m};
}

// Why a row stays empty.
ReproducedRow empty_row(const PaperTable& table, const PaperRow& row, const std::string& why) {
  ReproducedRow result{.paper = row, .has_data = false, .here = {}, .note = why};
  result.here.resize(variants_of(table).size());
  return result;
}

}  // namespace

ReproducedRow object_row(const PaperTable& table, const PaperRow& row, const KittiData& data,
                         const ReproduceOptions& options, const ReproduceProgress& progress) {
  const ObjectName name = parse_name(row.name);
  const auto drive = data.raw.find(name.drive);
  if (drive == data.raw.end()) return empty_row(table, row, "data missing");
  const std::optional<fs::path> boxes = car_detections_of(data, name.drive);
  if (!boxes)
    return empty_row(table, row, "no detections (detections/pointrcnn_car of the tracking sequence)");
  const Dataset dataset = open_dataset(drive->second, {});
  const std::vector<ObjectBox> annotated = annotations_of(data, dataset, name.drive);
  if (annotated.empty()) return empty_row(table, row, "no annotations (tracklet_labels.xml or label_02)");
  const std::vector<ObjectPose> truth = objects_in_map(annotated, smooth_drive(dataset).at_stamps.poses);
  const auto labelled = std::ranges::count_if(truth, [&](const ObjectPose& object) {
    return object.id == name.id && object.frame <= options.last_frame;
  });
  if (labelled == 0) return empty_row(table, row, "not labelled in the scans that are there");
  const DetectionList detections = read_detections({*boxes}, dataset.calibration);

  ReproducedRow result{
      .paper = row, .has_data = true, .here = {}, .note = fmt::format("labelled in {} scans", labelled)};
  for (const Variant& variant : variants_of(table)) {
    const fs::path folder = options.out / ("objects_" + name.drive) / variant.name;
    progress.on_run(folder.string());
    const bool done = run_unless_finished(dataset, detections, variant, folder, options, progress);
    result.here.push_back(done ? object_errors(truth, name.id, folder)
                               : std::vector<std::optional<double>>(table.measures.size()));
  }
  return result;
}

}  // namespace mlo
