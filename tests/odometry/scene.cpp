#include "odometry/scene.hpp"

#include <cmath>
#include <numbers>
#include <random>

namespace mlo::test {
namespace {

constexpr double kMaxRange_m = 40.0;
constexpr int kNumRows = 16;

// Puts world points into percepts as a moving, spinning lidar measures them.
class Observer {
 public:
  explicit Observer(const View& view)
      : view_(view),
        motion_(view.motion_compensated ? SweepMotion::none()
                                        : SweepMotion(view.T_previous_current, view.reference_fraction)),
        random_(view.seed) {}

  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }

  // Every fourth point becomes a feature, the others candidates, so that no point is seen twice.
  void add(FeatureSet& set, const Eigen::Vector3d& p_world, int row) {
    FeaturePoint point;
    Eigen::Vector3d p = view_.T_world_lidar.inverse() * p_world;
    if (p.norm() > kMaxRange_m) return;
    // The time depends on the direction, which depends on the time: a contraction, soon exact.
    double fraction = 0.5;
    for (int i = 0; i < 30; ++i) {
      fraction = 0.5 * (1.0 - std::atan2(p.y(), p.x()) / std::numbers::pi);
      p = (view_.T_world_lidar * motion_.T_reference_at(fraction)).inverse() * p_world;
    }
    std::normal_distribution<double> noise(0.0, 1.0);
    if (view_.noise_m > 0.0) p += view_.noise_m * noise(random_) * p.normalized();
    point.p_lidar = p.cast<float>();
    point.sweep_fraction = static_cast<float>(fraction);
    if (view_.rings) point.ring = static_cast<std::uint16_t>(row);
    (count_++ % 4 == 0 ? set.features : set.candidates).push_back(point);
  }

 private:
  const View view_;
  const SweepMotion motion_;
  std::mt19937_64 random_;
  std::size_t count_ = 0;
};

void add_ground(Observer& observer, const Eigen::Vector3d& center, FeatureSet& ground) {
  for (int row = 0; row < kNumRows; ++row) {
    const double radius = 4.0 + 1.2 * row;
    for (int column = 0; column < 200; ++column) {
      const double angle = 2.0 * std::numbers::pi * (column + observer.uniform(0.0, 1.0)) / 200.0;
      observer.add(ground,
                   {center.x() + radius * std::cos(angle), center.y() + radius * std::sin(angle), 0.0}, row);
    }
  }
}

void add_wall(Observer& observer, const Wall& wall, FeatureSet& surface) {
  const double length = (wall.to - wall.from).norm();
  for (int row = 0; row < kNumRows; ++row) {
    for (double along = observer.uniform(0.0, 0.5); along < length; along += 0.5) {
      const Eigen::Vector2d p = wall.from + along / length * (wall.to - wall.from);
      observer.add(surface, {p.x(), p.y(), 0.3 + 0.3 * row + observer.uniform(-0.1, 0.1)}, row);
    }
  }
}

}  // namespace

SE3 pose_above_ground(double x, double y, double yaw_rad, double roll_rad, double pitch_rad) {
  const Eigen::Quaterniond rotation = so3_exp({0.0, 0.0, yaw_rad}) * so3_exp({roll_rad, pitch_rad, 0.0});
  return {rotation, {x, y, 1.7}};
}

Percept observe(const Scene& scene, const View& view) {
  Observer observer(view);
  Percept percept;
  add_ground(observer, view.T_world_lidar.translation(), percept.ground);
  for (const Wall& wall : scene.walls) add_wall(observer, wall, percept.surface);
  for (const Eigen::Vector2d& post : scene.posts) {
    for (int row = 0; row < kNumRows; ++row) {
      observer.add(percept.edge, {post.x(), post.y(), 0.3 + 0.3 * row + observer.uniform(-0.1, 0.1)}, row);
    }
  }
  percept.mean_ground_smoothness = 0.1;
  return percept;
}

Scene street() {
  Scene scene;
  scene.walls = {{{-30.0, 9.0}, {6.0, 8.0}},   {{6.0, 8.0}, {8.0, 15.0}},    {{14.0, 14.0}, {35.0, 9.0}},
                 {{-30.0, -8.0}, {0.0, -9.0}}, {{4.0, -16.0}, {4.0, -9.0}},  {{4.0, -9.0}, {35.0, -11.0}},
                 {{30.0, -5.0}, {33.0, 6.0}},  {{-25.0, 6.0}, {-25.0, -6.0}}};
  for (int i = 0; i < 12; ++i) {
    scene.posts.emplace_back(-26.0 + 5.0 * i, 6.0 + 0.4 * (i % 3));
    scene.posts.emplace_back(-24.0 + 4.7 * i, -6.5 - 0.3 * (i % 4));
  }
  return scene;
}

Scene corridor() {
  return {{{{-60.0, 5.0}, {60.0, 5.0}}, {{-60.0, -5.0}, {60.0, -5.0}}}, {}};
}

}  // namespace mlo::test
