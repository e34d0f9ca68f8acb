#include "mlo/training/example_source.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/kitti_box.hpp"
#include "mlo/io/kitti_tracks.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/sequence_files.hpp"
#include "mlo/io/sweep_structure.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/trajectory_file.hpp"
#include "mlo/truth/object_truth.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;

/// What is true of a scan.
struct Labels {
  std::vector<LabelledBox> boxes;
  std::optional<LabelledView> view;
};

/// The points as a detector gets them.
std::vector<Point> usable_points(std::vector<Point> points, const SensorConfig& sensor) {
  std::erase_if(points, [&](const Point& point) {
    const double range_m = point.p_lidar.cast<double>().norm();
    return !(range_m >= sensor.min_range_m && range_m <= sensor.max_range_m);  // NaN fails both
  });
  correct_vertical_angle(points, sensor.vertical_correction_deg);
  return points;
}

/// Scans of a data set with labels for some of them; how the labels are kept is left to those who know.
class LabelledScans : public ExampleSource {
 public:
  LabelledScans(Dataset dataset, std::vector<std::size_t> indices, std::size_t min_points)
      : dataset_(std::move(dataset)), indices_(std::move(indices)), min_points_(min_points) {}

  std::size_t size() const override { return indices_.size(); }
  std::string name(std::size_t index) const override {
    return fmt::format("{}, scan {}", dataset_.root.string(), frame(index));
  }
  ExampleReading read(std::size_t index) const override {
    ScanReading reading = dataset_.scans->read(indices_[index]);
    if (!reading.scan) return {std::nullopt, reading.problem};
    const Labels labels = labels_of(frame(index));
    std::vector<Point> points = usable_points(std::move(reading.scan->points), dataset_.sensor);
    return {make_example(name(index), std::move(points), labels.boxes, labels.view, min_points_), ""};
  }

 protected:
  virtual Labels labels_of(std::size_t frame) const = 0;

 private:
  std::size_t frame(std::size_t index) const { return dataset_.scans->frame(indices_[index]); }

  Dataset dataset_;
  std::vector<std::size_t> indices_;
  std::size_t min_points_;
};

/// A sequence whose labels were read at once.
class LabelledSequence : public LabelledScans {
 public:
  LabelledSequence(Dataset dataset, std::vector<std::size_t> indices, std::size_t min_points,
                   LabelledFrames frames, std::optional<LabelledView> view)
      : LabelledScans(std::move(dataset), std::move(indices), min_points),
        frames_(std::move(frames)),
        view_(std::move(view)) {}

 protected:
  Labels labels_of(std::size_t frame) const override {
    const auto found = frames_.find(frame);
    return {found == frames_.end() ? std::vector<LabelledBox>{} : found->second, view_};
  }

 private:
  LabelledFrames frames_;
  std::optional<LabelledView> view_;
};

LabelledView view_of(const Calibration& calibration, const fs::path& place) {
  if (!calibration.P2 || !calibration.T_camera0_lidar) {
    throw InputError(fmt::format(
        "{}: has labels, but no calibration with P2 and the place of the lidar relative to the camera; "
        "put KITTI's calibration beside the scans",
        place.string()));
  }
  return {*calibration.T_camera0_lidar, *calibration.P2};
}

/// Scans of frames for which `chosen` is true.
template <class Chosen>
std::vector<std::size_t> scans_where(const Dataset& dataset, const Chosen& chosen) {
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < dataset.scans->size(); ++i) {
    if (chosen(dataset.scans->frame(i))) indices.push_back(i);
  }
  return indices;
}

/// The folder of exact truth: a simulation has it beside the scans' folders, at most two levels up.
std::optional<fs::path> find_exact_truth(const fs::path& root) {
  fs::path folder = fs::weakly_canonical(root);
  for (int level = 0; level < 3; ++level, folder = folder.parent_path()) {
    const fs::path truth = folder / "truth";
    if (fs::exists(truth / "objects.csv") && fs::exists(truth / "poses_stamp.txt")) return truth;
  }
  return std::nullopt;
}

std::unique_ptr<ExampleSource> open_exact(Dataset dataset, const fs::path& truth, std::size_t min_points) {
  const PoseList poses = read_trajectory(truth / "poses_stamp.txt");
  LabelledFrames frames = labelled_boxes(read_objects_csv(truth / "objects.csv"), poses);
  std::vector<std::size_t> indices =
      scans_where(dataset, [&](std::size_t frame) { return frames.contains(frame); });
  return std::make_unique<LabelledSequence>(std::move(dataset), std::move(indices), min_points,
                                            std::move(frames), std::nullopt);
}

/// An annotation of a raw drive; how much of it is hidden is not taken from there.
LabelledBox labelled_in_view(const ObjectBox& object, const LabelledView& view) {
  LabelledBox label{.type = object.type, .box = object.box_lidar};
  const auto image = project_box(box_in_camera(label.box, view.T_camera0_lidar), view.P2, view.image_size_px);
  if (image) label.height_px = image->bottom_px - image->top_px;
  return label;
}

/// Labels that come with a sequence; empty if there are none.
LabelledFrames sequence_labels(const Dataset& dataset) {
  if (!dataset.labels.empty()) {
    const LabelledView view = view_of(dataset.calibration, dataset.labels);
    return labelled_boxes(read_kitti_tracks(dataset.labels), view.T_camera0_lidar);
  }
  LabelledFrames frames;
  const std::vector<ObjectBox> objects = annotated_boxes(dataset);
  if (objects.empty()) return frames;
  const LabelledView view = view_of(dataset.calibration, dataset.root);
  for (const ObjectBox& object : objects) frames[object.frame].push_back(labelled_in_view(object, view));
  return frames;
}

std::unique_ptr<ExampleSource> open_sequence(Dataset dataset, LabelledFrames frames, std::size_t min_points) {
  const LabelledView view = view_of(dataset.calibration, dataset.root);
  const std::size_t first = frames.begin()->first;
  const std::size_t last = frames.rbegin()->first;
  std::vector<std::size_t> indices =
      scans_where(dataset, [&](std::size_t frame) { return frame >= first && frame <= last; });
  return std::make_unique<LabelledSequence>(std::move(dataset), std::move(indices), min_points,
                                            std::move(frames), view);
}

/// The KITTI object benchmark: each scan with labels and calibration of its own.
class ObjectBenchmark : public LabelledScans {
 public:
  ObjectBenchmark(Dataset dataset, std::vector<std::size_t> indices, std::size_t min_points, fs::path part)
      : LabelledScans(std::move(dataset), std::move(indices), min_points), part_(std::move(part)) {}

  static fs::path file_of(const fs::path& folder, std::size_t frame) {
    return folder / fmt::format("{:06}.txt", frame);
  }

 protected:
  Labels labels_of(std::size_t frame) const override {
    const fs::path calibration = file_of(part_ / "calib", frame);
    const LabelledView view = view_of(read_calibration_file(calibration), calibration);
    const auto records = read_kitti_object_labels(file_of(part_ / "label_2", frame));
    LabelledFrames frames = labelled_boxes(records, view.T_camera0_lidar);
    return {frames[0], view};
  }

 private:
  fs::path part_;  ///< of the benchmark: training
};

/// Scans that have labels, by frame. Users may have taken any of the benchmark's.
std::vector<ScanFile> labelled_scans(const fs::path& part) {
  std::vector<ScanFile> scans;
  for (const fs::directory_entry& label : fs::directory_iterator(part / "label_2")) {
    const std::optional<std::size_t> frame = parse_count(label.path().stem().string());
    if (!frame || label.path() != ObjectBenchmark::file_of(part / "label_2", *frame)) continue;
    const fs::path scan = part / "velodyne" / (label.path().stem().string() + ".bin");
    if (fs::exists(scan)) scans.push_back({.path = scan, .frame = *frame});
  }
  std::ranges::sort(scans, {}, &ScanFile::frame);
  return scans;
}

std::unique_ptr<ExampleSource> open_object_benchmark(const fs::path& part, const ExampleOptions& options) {
  Dataset dataset;
  dataset.format = "kitti_object";
  dataset.root = part / "velodyne";
  dataset.sensor = options.open.sensor.value_or(hdl64e());
  std::vector<ScanFile> scans = labelled_scans(part);
  if (scans.empty()) {
    throw InputError(
        fmt::format("{}: no label has the name of a scan of velodyne; they are called NNNNNN.txt",
                    (part / "label_2").string()));
  }
  for (ScanFile& scan : scans) scan.duration_s = 1.0 / dataset.sensor.rate_hz;
  std::vector<std::size_t> indices(scans.size());
  std::iota(indices.begin(), indices.end(), std::size_t{0});
  set_scans(dataset, std::move(scans), {.sensor = dataset.sensor});
  return std::make_unique<ObjectBenchmark>(std::move(dataset), std::move(indices), options.min_points, part);
}

std::optional<fs::path> find_object_benchmark(const fs::path& folder) {
  for (const fs::path& part : {folder, folder / "training"}) {
    if (fs::is_directory(part / "label_2") && holds_files(part / "velodyne", ".bin")) return part;
  }
  return std::nullopt;
}

}  // namespace

std::unique_ptr<ExampleSource> open_examples(const fs::path& folder, const ExampleOptions& options) {
  if (const auto part = find_object_benchmark(folder)) return open_object_benchmark(*part, options);
  Dataset dataset = open_dataset(folder, options.open);
  if (const auto truth = find_exact_truth(dataset.root)) {
    return open_exact(std::move(dataset), *truth, options.min_points);
  }
  LabelledFrames frames = sequence_labels(dataset);
  if (!frames.empty()) return open_sequence(std::move(dataset), std::move(frames), options.min_points);
  throw InputError(fmt::format(
      "{}: has no labels to learn from (truth/objects.csv and truth/poses_stamp.txt, label_02/NNNN.txt, "
      "tracklet_labels.xml, or label_2/NNNNNN.txt); give a folder that has them",
      folder.string()));
}

}  // namespace mlo
