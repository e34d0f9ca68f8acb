#include "mlo/simulator/object_model.hpp"

#include <cmath>
#include <numbers>
#include <utility>

namespace mlo::simulator {
namespace {

SE3 swung(const ModelPart& part, double angle_rad) {
  const Eigen::Quaterniond rotation = so3_exp({0.0, angle_rad, 0.0});
  return {rotation, part.pivot_m - rotation * part.pivot_m};
}

}  // namespace

SE3 ModelPart::T_ground_part(double travelled_m) const {
  if (swing_rad == 0.0) return {};
  return swung(*this, swing_rad * std::sin(2.0 * std::numbers::pi * cycles_per_m * travelled_m + phase_rad));
}

ObjectModel make_model(ObjectClass object_class, std::vector<ModelPart> parts) {
  constexpr int kPhases = 12;
  Eigen::AlignedBox3d box;
  for (const ModelPart& part : parts) {
    for (int phase = -kPhases; phase <= kPhases; ++phase) {
      if (part.swing_rad == 0.0 && phase != 0) continue;
      box.extend(transformed(swung(part, part.swing_rad * phase / kPhases), part.mesh).bounds());
    }
  }
  const Eigen::Vector3d shift(-box.center().x(), -box.center().y(), -box.min().z());
  for (ModelPart& part : parts) {
    part.mesh = transformed(SE3(Eigen::Quaterniond::Identity(), shift), std::move(part.mesh));
    part.pivot_m += shift;
  }
  return {object_class, box.sizes(), std::move(parts)};
}

}  // namespace mlo::simulator
