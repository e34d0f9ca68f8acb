#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "mlo/core/random.hpp"
#include "mlo/training/example.hpp"

namespace mlo::test {

inline constexpr double kGroundZ_m = -1.7;

inline LabelledBox made_label(const std::string& type, double x_m, double y_m, double yaw_rad) {
  const Eigen::Vector3d size =
      type == "pedestrian" ? Eigen::Vector3d(0.8, 0.6, 1.75) : Eigen::Vector3d(4.0, 1.7, 1.5);
  return {.type = type, .box = {{x_m, y_m, kGroundZ_m + 0.5 * size.z()}, size, yaw_rad}, .height_px = 50.0};
}

/// Points inside the boxes, none on their faces, and flat ground around them.
inline std::vector<Point> made_points(const std::vector<LabelledBox>& labels, std::uint64_t seed,
                                      int per_object = 40, int ground = 4000) {
  Random random(seed);
  std::vector<Point> points;
  const auto add = [&](const Eigen::Vector3d& p, float intensity) {
    Point point;
    point.p_lidar = p.cast<float>();
    point.intensity = intensity;
    points.push_back(point);
  };
  for (const LabelledBox& label : labels) {
    for (int i = 0; i < per_object; ++i) {
      const Eigen::Vector3d share(random.uniform(-0.49, 0.49), random.uniform(-0.49, 0.49),
                                  random.uniform(-0.49, 0.49));
      add(label.box.T_lidar_object() * share.cwiseProduct(label.box.size_lwh_m).eval(), 0.7F);
    }
  }
  for (int i = 0; i < ground; ++i) {
    add({random.uniform(-50.0, 50.0), random.uniform(-50.0, 50.0), kGroundZ_m - 0.02}, 0.1F);
  }
  return points;
}

inline TrainingExample made_example(const std::vector<LabelledBox>& labels, std::uint64_t seed = 1) {
  return make_example("made", made_points(labels, seed), labels, std::nullopt, 5);
}

/// A street with some objects, other ones for each seed.
inline TrainingExample made_street(std::uint64_t seed) {
  Random random(seed);
  std::vector<LabelledBox> labels;
  for (int i = 0; i < 4; ++i) {
    const double x_m = -30.0 + 18.0 * i + random.uniform(-3.0, 3.0);
    labels.push_back(made_label("car", x_m, random.uniform(3.0, 25.0), random.uniform(-3.0, 3.0)));
    labels.push_back(made_label("pedestrian", x_m, random.uniform(-25.0, -3.0), random.uniform(-3.0, 3.0)));
  }
  return made_example(labels, seed);
}

}  // namespace mlo::test
