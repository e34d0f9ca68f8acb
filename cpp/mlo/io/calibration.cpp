#include "mlo/io/calibration.hpp"

#include <initializer_list>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;
using Matrix34d = Eigen::Matrix<double, 3, 4>;

// "key: numbers" or "key numbers" per line. Numbers are parsed when asked for: other lines hold dates.
class KeyedNumbers {
 public:
  explicit KeyedNumbers(const fs::path& file) : file_(file) {
    std::size_t number = 0;
    for (const std::string& line : read_lines(file)) {
      const std::size_t key_end = line.find_first_of(": ");
      ++number;
      if (key_end != std::string::npos) lines_[line.substr(0, key_end)] = {number, line.substr(key_end + 1)};
    }
  }

  // Entries of a matrix under the first of the keys that is there; empty if none is.
  std::vector<double> numbers(std::initializer_list<const char*> keys, std::size_t count) const {
    for (const char* key : keys) {
      const auto found = lines_.find(key);
      if (found == lines_.end()) continue;
      const auto& [number, text] = found->second;
      const std::string where = fmt::format("{}:{}", file_.string(), number);
      std::vector<double> values = parse_numbers(text, where);
      if (values.size() == count) return values;
      throw InputError(fmt::format("{}: {} numbers for {}, {} are needed; fetch the calibration again", where,
                                   values.size(), key, count));
    }
    return {};
  }

  std::optional<Matrix34d> matrix34(std::initializer_list<const char*> keys) const {
    const std::vector<double> values = numbers(keys, 12);
    if (values.empty()) return std::nullopt;
    return Matrix34d(Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(values.data()));
  }

  std::optional<Eigen::Matrix3d> matrix33(std::initializer_list<const char*> keys) const {
    const std::vector<double> values = numbers(keys, 9);
    if (values.empty()) return std::nullopt;
    return Eigen::Matrix3d(Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(values.data()));
  }

  std::optional<SE3> pose(std::initializer_list<const char*> keys) const {
    const std::optional<Matrix34d> rows = matrix34(keys);
    return rows ? std::optional<SE3>(pose_of(*rows)) : std::nullopt;
  }

  // The raw files keep rotation (R) and translation (T) apart.
  std::optional<SE3> pose_of_R_and_T() const {
    const std::optional<Eigen::Matrix3d> R = matrix33({"R"});
    const std::vector<double> t = numbers({"T"}, 3);
    if (!R || t.empty()) return std::nullopt;
    Matrix34d rows;
    rows << *R, Eigen::Vector3d(t[0], t[1], t[2]);
    return pose_of(rows);
  }

 private:
  static SE3 pose_of(const Matrix34d& rows) {
    Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
    matrix.topRows<3>() = rows;
    return SE3::from_matrix(matrix);
  }

  fs::path file_;
  std::map<std::string, std::pair<std::size_t, std::string>> lines_;
};

SE3 rotation_only(const Eigen::Matrix3d& R) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = R;
  return SE3::from_matrix(matrix);
}

std::optional<SE3> inverse(const std::optional<SE3>& T) {
  return T ? std::optional<SE3>(T->inverse()) : std::nullopt;
}

}  // namespace

Calibration read_calibration_file(const fs::path& file) {
  const KeyedNumbers entries(file);
  Calibration calibration;
  calibration.P2 = entries.matrix34({"P2"});
  calibration.T_imu_lidar = inverse(entries.pose({"Tr_imu_to_velo", "Tr_imu_velo"}));
  // Tr of the odometry benchmark leads to the rectified camera; the others name a rectification of their own.
  calibration.T_camera0_lidar = entries.pose({"Tr"});
  const std::optional<SE3> T_unrectified_lidar = entries.pose({"Tr_velo_to_cam", "Tr_velo_cam"});
  const std::optional<Eigen::Matrix3d> R_rect = entries.matrix33({"R0_rect", "R_rect"});
  if (T_unrectified_lidar && R_rect) {
    calibration.T_camera0_lidar = rotation_only(*R_rect) * *T_unrectified_lidar;
  }
  return calibration;
}

Calibration read_raw_calibration(const fs::path& date_folder) {
  Calibration calibration;
  if (const fs::path file = date_folder / "calib_imu_to_velo.txt"; fs::exists(file)) {
    calibration.T_imu_lidar = inverse(KeyedNumbers(file).pose_of_R_and_T());
  }
  const fs::path camera_file = date_folder / "calib_cam_to_cam.txt";
  if (!fs::exists(camera_file)) return calibration;
  const KeyedNumbers camera(camera_file);
  calibration.P2 = camera.matrix34({"P_rect_02"});
  const fs::path lidar_file = date_folder / "calib_velo_to_cam.txt";
  if (!fs::exists(lidar_file)) return calibration;
  const std::optional<SE3> T_unrectified_lidar = KeyedNumbers(lidar_file).pose_of_R_and_T();
  const std::optional<Eigen::Matrix3d> R_rect = camera.matrix33({"R_rect_00"});
  if (T_unrectified_lidar && R_rect) {
    calibration.T_camera0_lidar = rotation_only(*R_rect) * *T_unrectified_lidar;
  }
  return calibration;
}

}  // namespace mlo
