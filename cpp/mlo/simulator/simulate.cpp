#include "mlo/simulator/simulate.hpp"

#include <cmath>
#include <set>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/simulator/dataset_writer.hpp"
#include "mlo/simulator/oxts.hpp"
#include "mlo/simulator/static_map.hpp"

namespace mlo::simulator {
namespace {

namespace fs = std::filesystem;

void check(const SimulationOptions& options) {
  if (options.sensor.elevations_deg().empty()) {
    throw InputError("simulate: the sensor has no rings; choose a preset such as hdl64e");
  }
  if (!(options.map_voxel_m > 0.0)) {
    throw InputError(fmt::format("simulate: map_voxel_m is {}; it must be above 0", options.map_voxel_m));
  }
}

void prepare_folder(const fs::path& out, bool overwrite) {
  std::error_code error;
  if (fs::exists(out) && !fs::is_empty(out)) {
    if (!overwrite) {
      throw InputError(
          fmt::format("{}: the folder is not empty; choose another, or --overwrite", out.string()));
    }
    if (!fs::exists(out / "synthetic.json")) {
      throw InputError(
          fmt::format("{}: holds something else than an earlier simulation (no synthetic.json); choose "
                      "another folder",
                      out.string()));
    }
    fs::remove_all(out);
  }
  fs::create_directories(out, error);
  if (error) throw InputError(fmt::format("{}: cannot be made: {}", out.string(), error.message()));
}

float to_millimetres(float value_m) {
  return std::round(value_m * 1000.0F) / 1000.0F;
}

/// Moves each point to where it would have been seen at the stamp, had nothing but the robot moved.
void compensate(std::vector<Point>& points, const Scene& scene, const Sweep& sweep, int columns) {
  const SE3 T_stamp_world = scene.robot.T_world_lidar(scene.terrain, sweep.stamp_s).inverse();
  std::vector<SE3> T_stamp_column(static_cast<std::size_t>(columns));
  const auto column_of = [&](double fraction) { return static_cast<std::size_t>(fraction * columns); };
  for (std::size_t column = 0; column < T_stamp_column.size(); ++column) {
    const double fraction = (static_cast<double>(column) + 0.5) / columns;
    const double time_s = sweep.start_s + fraction * (sweep.end_s - sweep.start_s);
    T_stamp_column[column] = T_stamp_world * scene.robot.T_world_lidar(scene.terrain, time_s);
  }
  parallel_for_each_index(
      points.size(),
      [&](std::size_t i) {
        const Eigen::Vector3d moved =
            T_stamp_column[column_of(points[i].sweep_fraction)] * points[i].p_lidar.cast<double>();
        points[i].p_lidar = moved.cast<float>().unaryExpr(&to_millimetres);
      },
      4096);
}

std::string oxts_at(const Scene& scene, double time_s) {
  constexpr double kStep_s = 0.01;
  const SE3 T_lidar_imu = Rig().T_imu_lidar.inverse();
  const auto pose = [&](double t) { return scene.robot.T_world_lidar(scene.terrain, t) * T_lidar_imu; };
  return oxts_line({pose(time_s - kStep_s), pose(time_s), pose(time_s + kStep_s), kStep_s});
}

SimulatedFrame make_frame(const SimulationOptions& options, const Scene& scene, const RayWorld& world,
                          const Sweep& sweep, std::size_t index) {
  constexpr double kBeyond_m = 30.0;  // long objects reach into view from farther away
  const auto pose = [&](double time_s) { return scene.robot.T_world_lidar(scene.terrain, time_s); };
  SimulatedFrame frame;
  frame.frame = index;
  frame.objects = objects_at(scene, world, sweep, options.errors.max_range_m + kBeyond_m);
  for (const SimulatedPoint& point : sweep.points) {
    frame.points.push_back(point.measured);
    frame.labels.push_back(point_label(point, frame.objects));
  }
  if (options.layout == Layout::odometry) compensate(frame.points, scene, sweep, options.sensor.columns);
  const Random random(mix(mix(options.scene.seed, 0xDE7), index));
  DetectorErrors none = DetectorErrors::none();
  none.max_range_m = options.detector.max_range_m;
  frame.noisy = detect(frame.objects, options.detector, random);
  frame.perfect = detect(frame.objects, none, random);
  frame.T_world_start = pose(sweep.start_s);
  frame.T_world_stamp = pose(sweep.stamp_s);
  frame.T_world_end = pose(sweep.end_s);
  frame.oxts = oxts_at(scene, sweep.stamp_s);
  return frame;
}

}  // namespace

SensorConfig default_sensor() {
  SensorConfig sensor = hdl64e();
  sensor.columns = 2160;
  return sensor;
}

SimulationReport simulate(const SimulationOptions& requested, const fs::path& out,
                          const std::function<void(std::size_t, std::size_t)>& progress) {
  SimulationOptions options = requested;
  options.errors.elevation_bias_deg = options.sensor.vertical_correction_deg;  // what readers will undo
  check(options);
  const Scene scene = make_scene(options.scene);
  prepare_folder(out, options.overwrite);
  RayWorld world(scene);

  const double period_s = 1.0 / options.sensor.rate_hz;
  std::size_t scans = std::max<std::size_t>(1, static_cast<std::size_t>(scene.duration_s / period_s));
  if (options.max_scans > 0) scans = std::min(scans, options.max_scans);
  const double first_stamp_s = stamp_fraction(options.sensor) * period_s;
  const SE3 T_map_world = scene.robot.T_world_lidar(scene.terrain, first_stamp_s).inverse();

  DatasetWriter writer(out, options, T_map_world);
  StaticMap map(options.map_voxel_m);
  SimulationReport report;
  std::set<int> met;
  for (std::size_t i = 0; i < scans; ++i) {
    const Sweep sweep = scan(scene, world, options.sensor, options.errors, period_s * static_cast<double>(i),
                             i, options.scene.seed);
    const SimulatedFrame frame = make_frame(options, scene, world, sweep, i);
    writer.write(frame);
    map.add(sweep, T_map_world);
    report.points += sweep.points.size();
    for (const ObjectTruth& object : frame.objects) met.insert(object.id);
    if (progress) progress(i + 1, scans);
  }
  writer.finish(map.points());
  report.scans = scans;
  report.objects = met.size();
  report.labels = writer.labels_written();
  report.map_points = map.points().size();
  report.way_m = scene.robot.planar.at(period_s * static_cast<double>(scans)).travelled_m;
  return report;
}

}  // namespace mlo::simulator
