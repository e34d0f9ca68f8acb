#include "mlo/io/true_poses.hpp"

#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/calibration.hpp"
#include "mlo/io/pose_files.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo {

PoseList read_true_poses(const std::filesystem::path& truth, const std::filesystem::path& calibration) {
  const bool is_oxts = std::filesystem::is_directory(truth);
  PoseList poses = is_oxts ? read_oxts_folder(truth) : read_trajectory(truth);
  if (calibration.empty()) return poses;
  const Calibration known = std::filesystem::is_directory(calibration) ? read_raw_calibration(calibration)
                                                                       : read_calibration_file(calibration);
  const std::optional<SE3>& T_body_lidar = is_oxts ? known.T_imu_lidar : known.T_camera0_lidar;
  if (!T_body_lidar) {
    throw InputError(
        fmt::format("{}: does not hold the lidar's place relative to the {}; give the calibration that "
                    "belongs to the truth",
                    calibration.string(), is_oxts ? "IMU" : "camera"));
  }
  return rebased(std::move(poses), *T_body_lidar);
}

}  // namespace mlo
