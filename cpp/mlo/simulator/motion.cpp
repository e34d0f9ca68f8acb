#include "mlo/simulator/motion.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mlo::simulator {
namespace {

struct CubicWeights {
  double p0, m0, p1, m1;
};

CubicWeights hermite(double u) {
  return {(1 + 2 * u) * (1 - u) * (1 - u), u * (1 - u) * (1 - u), u * u * (3 - 2 * u), u * u * (u - 1)};
}

}  // namespace

Eigen::Vector2d PlanarState::velocity_mps() const {
  return speed_mps * Eigen::Vector2d(std::cos(yaw_rad), std::sin(yaw_rad));
}

Motion Motion::at_rest(const Eigen::Vector2d& p_world, double yaw_rad) {
  return Motion({{.p_world = p_world, .yaw_rad = yaw_rad}});
}

PlanarState Motion::at(double time_s) const {
  if (states_.empty()) return {};
  const double step = time_s / kStep_s;
  if (step < 0.0 || step >= static_cast<double>(states_.size() - 1)) {
    PlanarState end = step < 0.0 ? states_.front() : states_.back();
    end.speed_mps = 0.0;
    end.yaw_rate_radps = 0.0;
    return end;
  }
  const auto i = static_cast<std::size_t>(step);
  const PlanarState& a = states_[i];
  const PlanarState& b = states_[i + 1];
  const double u = step - static_cast<double>(i);
  const CubicWeights w = hermite(u);
  PlanarState state;
  state.p_world = w.p0 * a.p_world + w.m0 * kStep_s * a.velocity_mps() + w.p1 * b.p_world +
                  w.m1 * kStep_s * b.velocity_mps();
  state.yaw_rad = w.p0 * a.yaw_rad + w.m0 * kStep_s * a.yaw_rate_radps + w.p1 * b.yaw_rad +
                  w.m1 * kStep_s * b.yaw_rate_radps;
  state.speed_mps = (1 - u) * a.speed_mps + u * b.speed_mps;
  state.yaw_rate_radps = (1 - u) * a.yaw_rate_radps + u * b.yaw_rate_radps;
  state.travelled_m = (1 - u) * a.travelled_m + u * b.travelled_m;
  return state;
}

Motion Motion::then(const Motion& next) const {
  Motion joined = *this;
  if (joined.states_.empty()) return next;
  // the next motion keeps its own idea of full turns; continue from ours
  const double travelled = joined.states_.back().travelled_m;
  const double turn =
      next.states_.empty() ? 0.0 : joined.states_.back().yaw_rad - next.states_.front().yaw_rad;
  for (std::size_t i = 1; i < next.states_.size(); ++i) {
    PlanarState state = next.states_[i];
    state.yaw_rad += std::round(turn / (2.0 * std::numbers::pi)) * 2.0 * std::numbers::pi;
    state.travelled_m += travelled;
    joined.states_.push_back(state);
  }
  return joined;
}

Motion follow(const Path& path, const std::vector<double>& s_m, const std::vector<double>& speed_mps,
              bool backwards) {
  std::vector<PlanarState> states;
  for (std::size_t i = 0; i < s_m.size(); ++i) {
    const PathPoint point = path.at(s_m[i]);
    PlanarState state;
    state.p_world = point.p_world;
    state.yaw_rad = point.heading_rad + (backwards ? std::numbers::pi : 0.0);
    state.speed_mps = backwards ? -speed_mps[i] : speed_mps[i];
    state.yaw_rate_radps = speed_mps[i] * point.curvature_per_m;
    state.travelled_m = s_m[i] - s_m.front();
    states.push_back(state);
  }
  return Motion(std::move(states));
}

Motion glide(const Path& path, double speed_mps, double wait_s, bool backwards) {
  constexpr double kRamp_s = 2.0;  // time to reach the speed, and to stop
  const double moving_s = path.length_m() / speed_mps + kRamp_s;
  std::vector<double> s(static_cast<std::size_t>(std::max(0.0, wait_s) / Motion::kStep_s) + 1, 0.0);
  std::vector<double> speed(s.size(), 0.0);
  for (double t = Motion::kStep_s; t < moving_s; t += Motion::kStep_s) {
    const double fade = std::clamp(std::min(t, moving_s - t) / kRamp_s, 0.0, 1.0);
    speed.push_back(speed_mps * fade);
    s.push_back(s.back() + 0.5 * Motion::kStep_s * (speed.back() + speed[speed.size() - 2]));
  }
  return follow(path, s, speed, backwards);
}

Motion cruise(const Path& path, double s_m, double speed_mps, double duration_s) {
  const auto steps = static_cast<std::size_t>(std::ceil(duration_s / Motion::kStep_s));
  std::vector<double> s;
  for (std::size_t i = 0; i <= steps; ++i)
    s.push_back(s_m + speed_mps * Motion::kStep_s * static_cast<double>(i));
  return follow(path, s, std::vector<double>(s.size(), speed_mps));
}

SE3 RobotMotion::T_world_lidar(const Terrain& terrain, double time_s) const {
  const PlanarState state = planar.at(time_s);
  const double pace = std::min(1.0, std::abs(state.speed_mps) / 8.0);
  const double t = time_s + suspension.phase_rad;
  // body resonance near 1.3 Hz, wheel and engine vibration near 5 and 9 Hz
  const double pitch = suspension.vibration_rad * pace * (std::sin(8.2 * t) + 0.3 * std::sin(31.0 * t + 1.0));
  const double roll =
      suspension.vibration_rad * pace * (0.8 * std::sin(7.1 * t + 2.0) + 0.2 * std::sin(57.0 * t)) +
      suspension.roll_per_lateral_acceleration_rad * state.speed_mps * state.yaw_rate_radps;
  const double heave = suspension.heave_m * pace * std::sin(8.9 * t + 0.5);
  const SE3 T_world_body = stand_on(terrain, state.p_world, state.yaw_rad);
  const SE3 T_body_lidar(so3_exp({0.0, pitch, 0.0}) * so3_exp({roll, 0.0, 0.0}),
                         {0.0, 0.0, lidar_height_m + heave});
  return T_world_body * T_body_lidar;
}

}  // namespace mlo::simulator
