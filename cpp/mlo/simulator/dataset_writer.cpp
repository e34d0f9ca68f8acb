#include "mlo/simulator/dataset_writer.hpp"

#include <algorithm>
#include <span>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "mlo/io/atomic_file.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo::simulator {
namespace {

namespace fs = std::filesystem;

template <class T>
std::string_view bytes(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void write_into(const fs::path& file, std::string_view content) {
  fs::create_directories(file.parent_path());
  write_file_atomically(file, content);
}

std::string row_line(const SE3& pose) {
  return kitti_row(pose) + "\n";
}

}  // namespace

DatasetWriter::DatasetWriter(fs::path out, const SimulationOptions& options, const SE3& T_map_world)
    : out_(std::move(out)), options_(options), T_map_world_(T_map_world) {
  const bool tracking = options_.layout == Layout::tracking;
  scans_ = tracking ? out_ / "velodyne" / "0000" : out_ / "sequences" / "00" / "velodyne";
  point_labels_ = tracking ? out_ / "labels" / "0000" : out_ / "sequences" / "00" / "labels";
  fs::create_directories(scans_);
  fs::create_directories(point_labels_);
  write_file_atomically(out_ / "README.txt", readme(options_));
  write_file_atomically(out_ / "synthetic.json", provenance_json(options_));
  objects_ = object_csv_header();
  noisy_ = perfect_ = detection_csv_header();
}

void DatasetWriter::write(const SimulatedFrame& frame) {
  std::vector<float> records;
  records.reserve(4 * frame.points.size());
  for (const Point& point : frame.points) {
    records.insert(records.end(), {point.p_lidar.x(), point.p_lidar.y(), point.p_lidar.z(), point.intensity});
  }
  const std::string name = fmt::format("{:06d}", frame.frame);
  write_file_atomically(scans_ / (name + ".bin"), bytes(records));
  write_file_atomically(point_labels_ / (name + ".label"), bytes(frame.labels));

  const std::string labels = label_lines(rig_, frame.frame, frame.objects);
  labels_written_ += static_cast<std::size_t>(std::ranges::count(labels, '\n'));
  label_02_ += labels;
  objects_ += object_csv_lines(T_map_world_, frame.frame, frame.objects);
  noisy_ += detection_csv_lines(frame.frame, frame.noisy);
  perfect_ += detection_csv_lines(frame.frame, frame.perfect);
  noisy_ab3dmot_ += ab3dmot_lines(rig_, frame.frame, frame.noisy);
  perfect_ab3dmot_ += ab3dmot_lines(rig_, frame.frame, frame.perfect);

  const SE3 T_map_lidar = T_map_world_ * frame.T_world_stamp;
  const SE3& T_camera_lidar = rig_.T_camera_lidar;
  const SE3& T_imu_lidar = rig_.T_imu_lidar;
  poses_start_ += row_line(T_map_world_ * frame.T_world_start);
  poses_stamp_ += row_line(T_map_lidar);
  poses_end_ += row_line(T_map_world_ * frame.T_world_end);
  poses_camera_ += row_line(T_camera_lidar * T_map_lidar * T_camera_lidar.inverse());
  poses_imu_ += row_line(T_imu_lidar * T_map_lidar * T_imu_lidar.inverse());
  times_ += fmt::format("{:.6e}\n", static_cast<double>(frame.frame) / options_.sensor.rate_hz);
  oxts_ += frame.oxts + "\n";
}

void DatasetWriter::write_sequence_files() const {
  if (options_.layout == Layout::tracking) {
    write_into(out_ / "calib" / "0000.txt", tracking_calibration(rig_));
    write_into(out_ / "oxts" / "0000.txt", oxts_);
    write_into(out_ / "poses_imu" / "0000.txt", poses_imu_);
    write_into(out_ / "label_02" / "0000.txt", label_02_);
    write_into(out_ / "detections" / "noisy" / "0000.txt", noisy_ab3dmot_);
    write_into(out_ / "detections" / "perfect" / "0000.txt", perfect_ab3dmot_);
    return;
  }
  const fs::path sequence = out_ / "sequences" / "00";
  write_into(sequence / "calib.txt", odometry_calibration(rig_));
  write_into(sequence / "times.txt", times_);
  write_into(out_ / "poses" / "00.txt", poses_camera_);
}

void DatasetWriter::finish(const std::vector<MapPoint>& static_map) {
  write_sequence_files();
  const fs::path truth = out_ / "truth";
  write_into(truth / "times.txt", times_);
  write_into(truth / "poses_start.txt", poses_start_);
  write_into(truth / "poses_stamp.txt", poses_stamp_);
  write_into(truth / "poses_end.txt", poses_end_);
  write_into(truth / "objects.csv", objects_);
  write_into(out_ / "detections" / "noisy.csv", noisy_);
  write_into(out_ / "detections" / "perfect.csv", perfect_);
  write_ply(truth / "static_map.ply", static_map);
}

}  // namespace mlo::simulator
