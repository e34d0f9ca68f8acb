#include "mlo/simulator/traffic.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mlo::simulator {
namespace {

constexpr double kFar_m = 1e6;
constexpr double kCautionStep_m = 1.0;
constexpr double kForesight_s = 0.5;  // makes up for the lag of the foot

/// Highest speed at every metre such that the bends ahead can be reached with comfortable braking.
std::vector<double> bend_speeds(const Path& lane, const TrafficRules& rules) {
  const auto count = static_cast<std::size_t>(lane.length_m() / kCautionStep_m) + 1;
  std::vector<double> limit(count);
  for (std::size_t i = count; i-- > 0;) {
    const double curvature = std::abs(lane.at(kCautionStep_m * static_cast<double>(i)).curvature_per_m);
    limit[i] = std::sqrt(rules.max_lateral_mps2 / std::max(curvature, 1e-4));
    if (i + 1 < count) {
      const double reachable =
          std::sqrt(limit[i + 1] * limit[i + 1] + rules.comfortable_braking_mps2 * kCautionStep_m);
      limit[i] = std::min(limit[i], reachable);
    }
  }
  return limit;
}

double limit_at(const std::vector<double>& limits, double s_m) {
  const double last = static_cast<double>(limits.size() - 1);
  return limits[static_cast<std::size_t>(std::clamp(s_m / kCautionStep_m, 0.0, last))];
}

/// Acceleration towards a desired speed behind an obstacle, Treiber et al. 2000, Eq. (2) and (3).
double intelligent_driver(double speed, double desired, double gap, double closing_speed,
                          const TrafficRules& rules) {
  const double a = rules.max_acceleration_mps2;
  const double b = rules.comfortable_braking_mps2;
  const double wanted_gap =
      rules.standstill_gap_m +
      std::max(0.0, speed * rules.gap_s + speed * closing_speed / (2.0 * std::sqrt(a * b)));
  const double free = desired > 0.01 ? std::pow(speed / desired, 4.0) : (speed > 0.0 ? 4.0 : 1.0);
  const double interaction = wanted_gap / std::max(gap, 0.1);
  return std::clamp(a * (1.0 - free - interaction * interaction), -6.0, a);
}

/// Distance to the nearest stop line that the driver must and can obey.
double gap_to_red_light(double front_m, double speed, double time_s, const std::vector<RedLight>& lights) {
  double gap = kFar_m;
  for (const RedLight& light : lights) {
    const double distance = light.s_m - front_m;
    const bool can_stop = distance > speed * speed / (2.0 * 4.0);
    if (light.red_at(time_s) && distance > 0.0 && can_stop) gap = std::min(gap, distance);
  }
  return gap;
}

}  // namespace

bool RedLight::red_at(double time_s) const {
  const double in_period = std::fmod(std::fmod(time_s - phase_s, period_s) + period_s, period_s);
  return in_period < red_s;
}

std::vector<Motion> drive_lane(const Path& lane, const std::vector<Driver>& front_to_back,
                               const std::vector<RedLight>& lights, const TrafficRules& rules,
                               double duration_s) {
  const std::vector<double> limits = bend_speeds(lane, rules);
  const auto steps = static_cast<std::size_t>(std::ceil(duration_s / Motion::kStep_s));
  const std::size_t count = front_to_back.size();
  std::vector<std::vector<double>> s(count), speed(count);
  std::vector<double> acceleration(count, 0.0);
  for (std::size_t i = 0; i < count; ++i) {
    s[i].push_back(front_to_back[i].s_start_m);
    speed[i].push_back(front_to_back[i].start_speed_mps);
  }
  for (std::size_t step = 0; step < steps; ++step) {
    const double time_s = Motion::kStep_s * static_cast<double>(step);
    for (std::size_t i = 0; i < count; ++i) {
      const Driver& driver = front_to_back[i];
      const double v = speed[i][step];
      const double front = s[i][step] + 0.5 * driver.length_m;
      double ahead_gap = kFar_m;
      double ahead_speed = v;
      if (i > 0) {
        ahead_gap = s[i - 1][step] - 0.5 * front_to_back[i - 1].length_m - front;
        ahead_speed = speed[i - 1][step];
      }
      const double desired =
          std::min(driver.desired_mps(time_s), limit_at(limits, s[i][step] + kForesight_s * v));
      const double behind_vehicle = intelligent_driver(v, desired, ahead_gap, v - ahead_speed, rules);
      const double at_light =
          intelligent_driver(v, desired, gap_to_red_light(front, v, time_s, lights), v, rules);
      // the foot moves gradually: a first-order lag of 0.25 s
      acceleration[i] += Motion::kStep_s / 0.25 * (std::min(behind_vehicle, at_light) - acceleration[i]);
      const double next = std::max(0.0, v + Motion::kStep_s * acceleration[i]);
      speed[i].push_back(next);
      s[i].push_back(s[i][step] + 0.5 * Motion::kStep_s * (v + next));
    }
  }
  std::vector<Motion> motions;
  for (std::size_t i = 0; i < count; ++i) motions.push_back(follow(lane, s[i], speed[i]));
  return motions;
}

}  // namespace mlo::simulator
