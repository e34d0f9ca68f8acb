#include "mlo/network/box_code.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/core/log_odds.hpp"

namespace mlo {
namespace {

// A size that no code may leave, in logarithms of the mean: exp() of anything else may be infinite.
constexpr double kMaxLogSize = 3.0;
constexpr double kMinSide_m = 0.05;

Eigen::Vector3d center_scale(const Eigen::Vector3d& mean_size, const BoxCodeSpec& code) {
  if (!code.center_in_sizes) return Eigen::Vector3d::Ones();
  const double diagonal = mean_size.head<2>().norm();
  return {diagonal, diagonal, mean_size.z()};
}

}  // namespace

AngleCode encode_angle(double yaw_rad, const BoxCodeSpec& code) {
  const double bin_rad = 2.0 * std::numbers::pi / code.angle_bins;
  const double bins = (yaw_rad - code.first_angle_rad) / bin_rad;
  const double nearest = std::round(bins);
  const long bin = static_cast<long>(nearest) % code.angle_bins;
  return {static_cast<int>(bin < 0 ? bin + code.angle_bins : bin), 2.0 * (bins - nearest)};
}

double decode_angle(const AngleCode& angle, const BoxCodeSpec& code) {
  const double bin_rad = 2.0 * std::numbers::pi / code.angle_bins;
  return std::remainder(code.first_angle_rad + bin_rad * (angle.bin + 0.5 * angle.residual),
                        2.0 * std::numbers::pi);
}

Eigen::Matrix<double, 6, 1> encode_box(const Box3d& box, const Eigen::Vector3d& candidate,
                                       std::size_t class_index, const NetworkArchitecture& architecture) {
  const Eigen::Vector3d& mean = architecture.mean_sizes_lwh_m[class_index];
  Eigen::Matrix<double, 6, 1> code;
  code.head<3>() = (box.center_lidar_m - candidate).cwiseQuotient(center_scale(mean, architecture.box_code));
  code.tail<3>() = architecture.box_code.log_size
                       ? Eigen::Vector3d(box.size_lwh_m.cwiseQuotient(mean).array().log())
                       : Eigen::Vector3d(0.5 * box.size_lwh_m);
  return code;
}

Box3d decode_box(const Eigen::RowVectorXf& code, const Eigen::Vector3d& candidate, std::size_t class_index,
                 const NetworkArchitecture& architecture) {
  const Eigen::Vector3d& mean = architecture.mean_sizes_lwh_m[class_index];
  const BoxCodeSpec& spec = architecture.box_code;
  const Eigen::Vector3d offset = code.head<3>().transpose().cast<double>();
  const Eigen::Array3d size = code.segment<3>(3).transpose().cast<double>().array();
  Box3d box;
  box.center_lidar_m = candidate + offset.cwiseProduct(center_scale(mean, spec));
  box.size_lwh_m = spec.log_size
                       ? Eigen::Vector3d(mean.array() * size.max(-kMaxLogSize).min(kMaxLogSize).exp())
                       : Eigen::Vector3d((2.0 * size).max(kMinSide_m));
  Eigen::Index bin = 0;
  code.segment(6, spec.angle_bins).maxCoeff(&bin);
  box.yaw_rad =
      decode_angle({static_cast<int>(bin), static_cast<double>(code[6 + spec.angle_bins + bin])}, spec);
  return box;
}

std::vector<Detection> decode_boxes(const NetworkOutput& output, const NetworkArchitecture& architecture,
                                    double min_confidence) {
  std::vector<Detection> boxes;
  for (Eigen::Index i = 0; i < output.candidates.rows(); ++i) {
    Eigen::Index best = 0;
    const double logit = static_cast<double>(output.class_logits.row(i).maxCoeff(&best));
    const double confidence = probability(logit);
    if (!(confidence >= min_confidence)) continue;
    const auto class_index = static_cast<std::size_t>(best);
    boxes.push_back({architecture.classes[class_index],
                     decode_box(output.box_codes.row(i), output.candidates.row(i).transpose().cast<double>(),
                                class_index, architecture),
                     confidence});
  }
  return boxes;
}

}  // namespace mlo
