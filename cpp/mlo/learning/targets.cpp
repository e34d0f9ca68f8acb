#include "mlo/learning/targets.hpp"

#include <algorithm>
#include <cmath>

#include "mlo/network/box_code.hpp"

namespace mlo {
namespace {

// Boxes are as wide as the labels say, and points stray from them.
constexpr double kOnObject_m = 0.1;
constexpr double kIgnored_m = 0.3;

const TargetBox* box_around(const Eigen::Vector3d& point, std::span<const TargetBox> boxes, double margin_m) {
  const auto found = std::ranges::find_if(
      boxes, [&](const TargetBox& target) { return target.box.contains(point, margin_m); });
  return found == boxes.end() ? nullptr : &*found;
}

void set_class(CandidateTargets& targets, Eigen::Index i, const Eigen::Vector3d& candidate,
               const TargetBox& target, const NetworkArchitecture& architecture) {
  const auto at = static_cast<std::size_t>(i);
  targets.class_index[at] = target.class_index;
  targets.centerness[at] = static_cast<float>(centerness(target.box, candidate));
  targets.codes.row(i) =
      encode_box(target.box, candidate, static_cast<std::size_t>(target.class_index), architecture)
          .transpose()
          .cast<float>();
  const AngleCode angle = encode_angle(target.box.yaw_rad, architecture.box_code);
  targets.angle_bin[at] = angle.bin;
  targets.angle_residual[at] = static_cast<float>(angle.residual);
  targets.corners.row(i) << target.box.center_lidar_m.transpose().cast<float>(),
      target.box.size_lwh_m.transpose().cast<float>(), static_cast<float>(target.box.yaw_rad);
}

}  // namespace

double centerness(const Box3d& box, const Eigen::Vector3d& point) {
  const Eigen::Array3d p_object = (box.T_lidar_object().inverse() * point).array().abs();
  const Eigen::Array3d half = 0.5 * box.size_lwh_m.array();
  const Eigen::Array3d ratio = ((half - p_object) / (half + p_object)).max(0.0);
  return std::cbrt(ratio.prod());
}

CandidateTargets assign_targets(const PointRows& origins, const PointRows& candidates,
                                std::span<const TargetBox> boxes, const NetworkArchitecture& architecture) {
  const Eigen::Index count = candidates.rows();
  const auto size = static_cast<std::size_t>(count);
  CandidateTargets targets{.class_index = std::vector<std::int64_t>(size, CandidateTargets::kBackground),
                           .centerness = std::vector<float>(size, 0.0F),
                           .codes = RowMatrix::Zero(count, 6),
                           .angle_bin = std::vector<std::int64_t>(size, 0),
                           .angle_residual = std::vector<float>(size, 0.0F),
                           .corners = RowMatrix::Zero(count, 7),
                           .is_on_object = std::vector<std::uint8_t>(size, 0),
                           .shifts = PointRows::Zero(count, 3)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector3d candidate = candidates.row(i).transpose().cast<double>();
    const TargetBox* target = box_around(candidate, boxes, 0.0);
    if (target != nullptr && target->class_index != TargetBox::kIgnored) {
      set_class(targets, i, candidate, *target, architecture);
    } else if (target != nullptr || box_around(candidate, boxes, kIgnored_m) != nullptr) {
      targets.class_index[static_cast<std::size_t>(i)] = CandidateTargets::kIgnored;
    }
    const Eigen::Vector3d origin = origins.row(i).transpose().cast<double>();
    const TargetBox* on = box_around(origin, boxes, kOnObject_m);
    if (on == nullptr || on->class_index == TargetBox::kIgnored) continue;
    targets.is_on_object[static_cast<std::size_t>(i)] = 1;
    targets.shifts.row(i) = (on->box.center_lidar_m - origin).transpose().cast<float>();
  }
  return targets;
}

}  // namespace mlo
