#include <cmath>
#include <numbers>

#include "mlo/simulator/object_model.hpp"

namespace mlo::simulator {
namespace {

using Eigen::Vector3d;

/// Torso and head of a person whose hips are at a place; leaning forward by lean_rad.
Mesh upper_body(const Vector3d& hips, double height_m, double lean_rad) {
  const double torso = 0.31 * height_m;
  const Vector3d up(std::sin(lean_rad), 0.0, std::cos(lean_rad));
  Mesh mesh = ellipsoid(hips + 0.5 * torso * up, {0.13, 0.20, 0.62 * torso}, Surface::cloth);
  mesh += tube(hips + 0.8 * torso * up - Vector3d(0, 0.19, 0), hips + 0.8 * torso * up + Vector3d(0, 0.19, 0),
               0.075, 0.075, Surface::cloth);
  mesh += ellipsoid(hips + (torso + 0.12 * height_m) * up, {0.10, 0.085, 0.125}, Surface::skin);
  return mesh;
}

}  // namespace

ObjectModel make_pedestrian(Random random) {
  const double height = random.uniform(1.55, 1.92);
  const double hip = 0.5 * height;
  const double shoulder = 0.8 * height;
  const double stride_cycles_per_m = 0.7 * 1.75 / height;
  std::vector<ModelPart> parts{{.mesh = upper_body({0, 0, hip}, height, 0.05)}};
  for (const double side : {-1.0, 1.0}) {
    const double phase = side > 0.0 ? 0.0 : std::numbers::pi;
    const Vector3d hip_joint(0.0, 0.1 * side, hip);
    Mesh leg = tube(hip_joint, {0.0, 0.1 * side, 0.26 * height}, 0.085, 0.06, Surface::cloth);
    leg += tube({0.0, 0.1 * side, 0.26 * height}, {-0.02, 0.1 * side, 0.06}, 0.06, 0.045, Surface::cloth);
    leg += cuboid({-0.07, 0.1 * side - 0.045, 0.0}, {0.19, 0.1 * side + 0.045, 0.08}, Surface::rubber);
    parts.push_back({leg, hip_joint, 0.42, stride_cycles_per_m, phase});
    const Vector3d shoulder_joint(0.0, 0.235 * side, shoulder);
    Mesh arm = tube(shoulder_joint, {0.0, 0.26 * side, 0.62 * height}, 0.05, 0.045, Surface::cloth);
    arm += tube({0.0, 0.26 * side, 0.62 * height}, {0.06, 0.26 * side, 0.46 * height}, 0.045, 0.035,
                Surface::skin);
    parts.push_back({arm, shoulder_joint, 0.38, stride_cycles_per_m, phase + std::numbers::pi});
  }
  return make_model(ObjectClass::pedestrian, std::move(parts));
}

ObjectModel make_cyclist(Random random) {
  constexpr double kWheel_m = 0.34;
  const double height = random.uniform(1.62, 1.88);
  Mesh bicycle;
  for (const double x : {-0.52, 0.52}) {
    bicycle += tube({x, -0.022, kWheel_m}, {x, 0.022, kWheel_m}, kWheel_m, kWheel_m, Surface::rubber, 14);
  }
  const Vector3d crank(-0.08, 0, 0.28), saddle(-0.22, 0, 0.92), head_tube(0.40, 0, 0.85);
  for (const auto& [from, to] : {std::pair{crank, saddle},
                                 {crank, head_tube},
                                 {saddle, head_tube},
                                 {crank, Vector3d(-0.52, 0, kWheel_m)},
                                 {head_tube, Vector3d(0.52, 0, kWheel_m)}}) {
    bicycle += tube(from, to, 0.022, 0.022, Surface::rail, 6);
  }
  bicycle += tube({0.38, -0.28, 1.02}, {0.38, 0.28, 1.02}, 0.018, 0.018, Surface::rail, 6);
  const Vector3d hips(-0.2, 0, 0.98);
  bicycle += upper_body(hips, height, 0.45);
  for (const double side : {-1.0, 1.0}) {
    bicycle += tube({0.02, 0.2 * side, 1.38}, {0.38, 0.25 * side, 1.04}, 0.05, 0.04, Surface::cloth);
  }
  std::vector<ModelPart> parts{{.mesh = bicycle}};
  for (const double side : {-1.0, 1.0}) {
    const Vector3d hip_joint(hips.x(), 0.1 * side, hips.z());
    const Vector3d knee(0.14, 0.1 * side, 0.68);
    Mesh leg = tube(hip_joint, knee, 0.08, 0.06, Surface::cloth);
    leg += tube(knee, {-0.02, 0.1 * side, 0.26}, 0.06, 0.045, Surface::cloth);
    leg += cuboid({-0.06, 0.1 * side - 0.045, 0.2}, {0.18, 0.1 * side + 0.045, 0.27}, Surface::rubber);
    parts.push_back({leg, hip_joint, 0.22, 0.18, side > 0.0 ? 0.0 : std::numbers::pi});
  }
  return make_model(ObjectClass::cyclist, std::move(parts));
}

}  // namespace mlo::simulator
