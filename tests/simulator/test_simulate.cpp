#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "mlo/core/error.hpp"
#include "mlo/io/dataset.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/sweep_structure.hpp"
#include "mlo/simulator/simulate.hpp"
#include "temp_folder.hpp"

namespace mlo::simulator {
namespace {

namespace fs = std::filesystem;

SimulationOptions short_city(Layout layout) {
  SimulationOptions options;
  options.scene = {.kind = SceneKind::city, .length_m = 40.0, .seed = 9};
  options.layout = layout;
  options.sensor.columns = 540;
  options.max_scans = 4;
  options.version = "test";
  return options;
}

std::map<std::string, std::string> all_files(const fs::path& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    std::ifstream file(entry.path(), std::ios::binary);
    files[fs::relative(entry.path(), folder).string()] = {std::istreambuf_iterator<char>(file), {}};
  }
  return files;
}

std::vector<std::uint32_t> read_labels(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  std::vector<std::uint32_t> labels(bytes.size() / 4);
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<char*>(labels.data()));
  return labels;
}

bool is_static(std::uint32_t label) {
  return label >> 16 == 0;
}

TEST(Simulate, SameSeedSameBytesAnotherSeedOthers) {
  const test::TempFolder folder;
  SimulationOptions options = short_city(Layout::tracking);
  simulate(options, folder.path() / "a", {});
  simulate(options, folder.path() / "b", {});
  const auto a = all_files(folder.path() / "a");
  EXPECT_EQ(a, all_files(folder.path() / "b"));
  EXPECT_EQ(a.size(), 4U * 2U + 16U);
  options.scene.seed = 10;
  simulate(options, folder.path() / "c", {});
  EXPECT_NE(a.at("velodyne/0000/000000.bin"), all_files(folder.path() / "c").at("velodyne/0000/000000.bin"));
}

TEST(Simulate, BothLayoutsOpenAsTheyAreWithTruth) {
  const test::TempFolder folder;
  for (const Layout layout : {Layout::tracking, Layout::odometry}) {
    const fs::path out = folder.path() / (layout == Layout::tracking ? "t" : "o");
    simulate(short_city(layout), out, {});
    const Dataset dataset = open_dataset(out, {});
    EXPECT_EQ(dataset.format, layout == Layout::tracking ? "kitti_tracking" : "kitti_odometry");
    EXPECT_EQ(dataset.scans->size(), 4U);
    EXPECT_TRUE(dataset.warnings.empty()) << dataset.warnings.front();
    ASSERT_TRUE(dataset.truth);
    const PoseList stamps = read_kitti_poses(out / "truth" / "poses_stamp.txt");
    ASSERT_EQ(dataset.truth->T_world_body.size(), stamps.T_world_body.size());
    for (std::size_t i = 0; i < stamps.T_world_body.size(); ++i) {
      const SE3 difference = stamps.T_world_body[i].inverse() * dataset.truth->T_world_body[i];
      EXPECT_LT(difference.translation().norm(), 1e-4) << "scan " << i;
      EXPECT_LT(difference.rotation_angle_rad(), 1e-6) << "scan " << i;
    }
    const ScanReading reading = dataset.scans->read(1);
    ASSERT_TRUE(reading.scan) << reading.problem;
    EXPECT_EQ(reading.scan->motion_compensated, layout == Layout::odometry);
    for (const Point& point : reading.scan->points) EXPECT_NE(point.ring, Point::kNoRing);
  }
}

/// Distance of each static point, placed by the true poses, from where its ray met the true scene, as seen
/// through the files alone.
std::vector<double> placement_errors(const fs::path& out, const Scene& scene, std::size_t frame) {
  const Dataset dataset = open_dataset(out, {});
  const bool compensated = dataset.format == "kitti_odometry";
  const SE3 start = read_kitti_poses(out / "truth" / "poses_start.txt").T_world_body.at(frame);
  const SE3 stamp = read_kitti_poses(out / "truth" / "poses_stamp.txt").T_world_body.at(frame);
  const SE3 end = read_kitti_poses(out / "truth" / "poses_end.txt").T_world_body.at(frame);
  Scan read = *dataset.scans->read(frame).scan;
  correct_vertical_angle(read.points, dataset.sensor.vertical_correction_deg);
  const std::string name = "00000" + std::to_string(frame) + ".label";
  const std::vector<std::uint32_t> labels =
      read_labels(compensated ? out / "sequences" / "00" / "labels" / name : out / "labels" / "0000" / name);
  EXPECT_EQ(labels.size(), read.points.size());

  // the same sweep again: where the rays really went
  const SimulationOptions options = short_city(Layout::tracking);
  RayWorld world(scene);
  const Sweep sweep = scan(scene, world, options.sensor, options.errors, 0.1 * static_cast<double>(frame),
                           frame, options.scene.seed);
  const SE3 T_map_world = scene.robot.T_world_lidar(scene.terrain, 0.05).inverse();
  std::vector<double> errors;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (!is_static(labels[i])) continue;
    const double s = read.points[i].sweep_fraction;
    const SE3 moving = s < 0.5 ? start * interpolate(start.inverse() * stamp, 2.0 * s)
                               : stamp * interpolate(stamp.inverse() * end, 2.0 * s - 1.0);
    const Eigen::Vector3d placed = (compensated ? stamp : moving) * read.points[i].p_lidar.cast<double>();
    errors.push_back((placed - T_map_world * sweep.points[i].p_world.cast<double>()).norm());
  }
  return errors;
}

TEST(Simulate, StaticPointsAgreeWithinTheNoiseWhenPlacedByTheTruePoses) {
  const test::TempFolder folder;
  const Scene scene = make_scene(short_city(Layout::tracking).scene);
  for (const Layout layout : {Layout::tracking, Layout::odometry}) {
    const fs::path out = folder.path() / (layout == Layout::tracking ? "t" : "o");
    simulate(short_city(layout), out, {});
    for (const std::size_t frame : {0U, 3U}) {
      const std::vector<double> errors = placement_errors(out, scene, frame);
      ASSERT_GT(errors.size(), 5000U);
      double squares = 0.0, worst = 0.0;
      for (const double error : errors) {
        squares += error * error;
        worst = std::max(worst, error);
      }
      const double sigma = LidarErrors{}.range_noise_m;
      EXPECT_NEAR(std::sqrt(squares / static_cast<double>(errors.size())), sigma, 0.1 * sigma);
      EXPECT_LT(worst, 6.0 * sigma);
    }
  }
}

TEST(Simulate, StaticMapIsWhatTheScansSawWithoutMovables) {
  const test::TempFolder folder;
  const SimulationReport report = simulate(short_city(Layout::tracking), folder.path() / "t", {});
  const std::vector<MapPoint> map = read_map(folder.path() / "t" / "truth" / "static_map.ply");
  ASSERT_EQ(map.size(), report.map_points);
  const Scene scene = make_scene(short_city(Layout::tracking).scene);
  const SE3 T_world_map = scene.robot.T_world_lidar(scene.terrain, 0.05);
  for (const MapPoint& point : map) {
    if (point.label != MapLabel::ground) continue;
    const Eigen::Vector3d p = T_world_map * point.p_map.cast<double>();
    ASSERT_LT(std::abs(p.z() - scene.terrain.height(p.head<2>())), 0.3);  // kerbs and rough grass
  }
}

TEST(Simulate, LabelsAndPerfectDetectionsNameTheSameObjects) {
  const test::TempFolder folder;
  SimulationOptions options = short_city(Layout::tracking);
  options.sensor.columns = 2160;
  const SimulationReport report = simulate(options, folder.path() / "t", {});
  const auto files = all_files(folder.path() / "t");
  EXPECT_GT(report.labels, 10U);
  EXPECT_NE(files.at("label_02/0000.txt").find("Car"), std::string::npos);

  // every car that is labelled within the detector's reach has a perfect detection with the same box
  std::istringstream detections(files.at("detections/perfect/0000.txt"));
  std::map<std::string, int> boxes;  // frame and place
  const auto place = [](int frame, double x, double z) {
    return std::to_string(frame) + " " + std::to_string(std::lround(10.0 * x)) + " " +
           std::to_string(std::lround(10.0 * z));
  };
  for (std::string line; std::getline(detections, line);) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::vector<double> v{std::istream_iterator<double>(words), {}};
    ASSERT_EQ(v.size(), 15U);
    if (v[1] == 2.0) ++boxes[place(static_cast<int>(v[0]), v[10], v[12])];
  }
  std::istringstream labels(files.at("label_02/0000.txt"));
  int cars = 0;
  for (std::string line; std::getline(labels, line);) {
    std::istringstream words(line);
    const std::vector<std::string> w{std::istream_iterator<std::string>(words), {}};
    ASSERT_EQ(w.size(), 17U);
    if (w[2] != "Car" || std::stod(w[15]) > 60.0) continue;
    ++cars;
    EXPECT_TRUE(boxes.contains(place(std::stoi(w[0]), std::stod(w[13]), std::stod(w[15])))) << line;
  }
  EXPECT_GT(cars, 5);
}

TEST(Simulate, SaysThatItIsSyntheticWithSeedVersionAndOptions) {
  const test::TempFolder folder;
  SimulationOptions options = short_city(Layout::odometry);
  options.detector.miss_share = 0.125;
  simulate(options, folder.path() / "o", {});
  const auto files = all_files(folder.path() / "o");
  EXPECT_EQ(files.at("README.txt").rfind("SYNTHETIC DATA", 0), 0U);
  const auto json = nlohmann::json::parse(files.at("synthetic.json"));
  EXPECT_TRUE(json.at("synthetic").get<bool>());
  EXPECT_EQ(json.at("seed"), 9);
  EXPECT_EQ(json.at("version"), "test");
  EXPECT_EQ(json.at("detector_errors").at("miss_share"), 0.125);
  EXPECT_EQ(json.at("lidar_errors").at("elevation_bias_deg"), options.sensor.vertical_correction_deg);
}

TEST(Simulate, KeepsItsHandsOffFoldersOfOthers) {
  const test::TempFolder folder;
  folder.write("mine/notes.txt", "precious");
  SimulationOptions options = short_city(Layout::tracking);
  options.max_scans = 1;
  EXPECT_THROW(simulate(options, folder.path() / "mine", {}), InputError);
  options.overwrite = true;
  EXPECT_THROW(simulate(options, folder.path() / "mine", {}), InputError);
  EXPECT_EQ(all_files(folder.path() / "mine").at("notes.txt"), "precious");

  options.max_scans = 2;
  simulate(options, folder.path() / "sim", {});
  options.max_scans = 1;
  simulate(options, folder.path() / "sim", {});
  EXPECT_FALSE(all_files(folder.path() / "sim").contains("velodyne/0000/000001.bin"));
}

TEST(Simulate, RefusesASensorWithoutRingsAndAMapWithoutSpacing) {
  const test::TempFolder folder;
  SimulationOptions options = short_city(Layout::tracking);
  options.map_voxel_m = 0.0;
  EXPECT_THROW(simulate(options, folder.path() / "x", {}), InputError);
  options = short_city(Layout::tracking);
  options.sensor = SensorConfig{};
  EXPECT_THROW(simulate(options, folder.path() / "x", {}), InputError);
}

}  // namespace
}  // namespace mlo::simulator
