#include "mlo/tracking/object_filter.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include "mlo/core/log_odds.hpp"

namespace mlo {
namespace {

constexpr double kMinSpeedToTell_mps = 2.0;  // slower objects do not tell front from back
constexpr double kMaxFlips = 10.0;           // memory of which way the detector says is the front
constexpr double kRobustDistance = 9.0;      // squared innovation beyond which a measurement loses weight

double square(double x) {
  return x * x;
}

/// Covariance with these standard deviations along and across a heading.
Eigen::Matrix2d oriented_covariance(double yaw_rad, double along_sd, double across_sd) {
  const Eigen::Matrix2d R = Eigen::Rotation2Dd(yaw_rad).toRotationMatrix();
  return R * Eigen::Vector2d(square(along_sd), square(across_sd)).asDiagonal() * R.transpose();
}

}  // namespace

double confidence_logit(double confidence) {
  constexpr double kMin = -2.0;
  constexpr double kMax = 12.0;
  return std::isnan(confidence) ? kMin : std::clamp(log_odds(confidence), kMin, kMax);
}

BoxMeasurement measure(const Detection& detection, const SE3& T_map_lidar, const BoxNoiseConfig& config) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  constexpr double kWidthOverLength = 0.4;
  const double logit = confidence_logit(detection.confidence);
  const auto sd = [&](double at_zero, double decay) { return at_zero * std::exp(-decay * logit); };
  const double length_sd_m = sd(config.size_m, config.size_decay);
  return {.box = place(detection.box, T_map_lidar),
          .along_sd_m = sd(config.along_m, config.along_decay),
          .across_sd_m = sd(config.across_m, config.across_decay),
          .height_sd_m = sd(config.height_m, config.height_decay),
          .yaw_sd_rad = sd(config.yaw_deg * kDegree, config.yaw_decay),
          .size_sd_m = {length_sd_m, kWidthOverLength * length_sd_m, kWidthOverLength * length_sd_m}};
}

void ObjectFilter::Scalar::update(double measured, double measured_variance) {
  const double gain = variance / (variance + measured_variance);
  value += gain * (measured - value);
  variance *= 1.0 - gain;
}

ObjectFilter::ObjectFilter(const BoxMeasurement& first, bool wheeled, const ObjectMotionConfig& config)
    : wheeled_(wheeled) {
  const PlacedBox& box = first.box;
  for (Planar& planar : planar_) {
    planar.state.head<2>() = box.center_map_m.head<2>();
    planar.covariance.topLeftCorner<2, 2>() =
        oriented_covariance(box.yaw_rad, first.along_sd_m, first.across_sd_m);
  }
  const double across_sd = wheeled ? config.sideways_speed_mps : config.start_speed_mps;
  planar_[kMoving].covariance.bottomRightCorner<2, 2>() =
      oriented_covariance(box.yaw_rad, config.start_speed_mps, across_sd);
  height_ = {box.center_map_m.z(), square(first.height_sd_m)};
  for (int i = 0; i < 3; ++i) size_[i] = {box.size_lwh_m(i), square(first.size_sd_m(i))};
  constexpr double kStartTurnRate_radps = 0.3;
  yaw_ = {box.yaw_rad, 0.0};
  yaw_covariance_ = Eigen::Vector2d(square(first.yaw_sd_rad), square(kStartTurnRate_radps)).asDiagonal();
}

void ObjectFilter::mix(const ObjectMotionConfig& config) {
  const Planar before[2] = {planar_[kStanding], planar_[kMoving]};
  for (int to = 0; to < 2; ++to) {
    double share[2];
    for (int from = 0; from < 2; ++from) {
      const double chance = from == to ? 1.0 - config.switch_probability : config.switch_probability;
      share[from] = chance * before[from].probability;
    }
    Planar& mixed = planar_[to];
    mixed.probability = share[0] + share[1];
    mixed.state = (share[0] * before[0].state + share[1] * before[1].state) / mixed.probability;
    mixed.covariance.setZero();
    for (int from = 0; from < 2; ++from) {
      const Vector4d apart = before[from].state - mixed.state;
      mixed.covariance +=
          share[from] / mixed.probability * (before[from].covariance + apart * apart.transpose());
    }
  }
  planar_[kStanding].state.tail<2>().setZero();
  planar_[kStanding].covariance.rightCols<2>().setZero();
  planar_[kStanding].covariance.bottomRows<2>().setZero();
}

void ObjectFilter::predict(double dt_s, const ObjectMotionConfig& config) {
  mix(config);
  Matrix4d F = Matrix4d::Identity();
  F.topRightCorner<2, 2>() = dt_s * Eigen::Matrix2d::Identity();
  Planar& moving = planar_[kMoving];
  moving.state = F * moving.state;
  moving.covariance = F * moving.covariance * F.transpose();
  Eigen::Matrix<double, 4, 2> G;
  G << 0.5 * dt_s * dt_s * Eigen::Matrix2d::Identity(), dt_s * Eigen::Matrix2d::Identity();
  moving.covariance += square(config.acceleration_mps2) * G * G.transpose();
  planar_[kStanding].covariance.topLeftCorner<2, 2>() +=
      square(config.standing_noise_m) * dt_s * Eigen::Matrix2d::Identity();
  moving.covariance.topLeftCorner<2, 2>() +=
      square(config.standing_noise_m) * dt_s * Eigen::Matrix2d::Identity();

  height_.variance += square(config.height_noise_m) * dt_s;
  for (Scalar& size : size_) size.variance += square(config.size_noise_m) * dt_s;

  // What stands does not turn.
  const double moves = moving.probability;
  yaw_(1) *= moves;
  yaw_(0) = wrapped_angle(yaw_(0) + dt_s * yaw_(1));
  Eigen::Matrix2d turn;
  turn << 1.0, dt_s, 0.0, 1.0;
  yaw_covariance_ = turn * yaw_covariance_ * turn.transpose();
  const double turn_noise = moves * config.turn_noise_degps2 * std::numbers::pi / 180.0;
  const Eigen::Vector2d g(0.5 * dt_s * dt_s, dt_s);
  yaw_covariance_ += square(turn_noise) * g * g.transpose();
}

void ObjectFilter::update(const BoxMeasurement& measurement, const ObjectMotionConfig& config) {
  const PlacedBox& box = measurement.box;
  const Distance apart = distance(measurement, 0.0);
  // A far-off box (a partly seen object) pulls less than its noise promises: Cauchy's weight.
  const double scale = std::max(1.0, apart.position / kRobustDistance);
  const Eigen::Matrix2d noise =
      scale * oriented_covariance(box.yaw_rad, measurement.along_sd_m, measurement.across_sd_m);
  update_yaw(box.yaw_rad, measurement.yaw_sd_rad);
  update_planar(box.center_map_m.head<2>(), noise);
  if (wheeled_) forbid_sideways_motion(config.sideways_speed_mps);
  turn_round_if_backwards();
  height_.update(box.center_map_m.z(), scale * square(measurement.height_sd_m));
  for (int i = 0; i < 3; ++i) size_[i].update(box.size_lwh_m(i), scale * square(measurement.size_sd_m(i)));
}

void ObjectFilter::update_planar(const Eigen::Vector2d& measured_m, const Eigen::Matrix2d& noise) {
  double sum = 0.0;
  for (Planar& planar : planar_) {
    const Eigen::Matrix2d S = planar.covariance.topLeftCorner<2, 2>() + noise;
    const Eigen::Matrix2d S_inverse = S.inverse();
    const Eigen::Vector2d innovation_m = measured_m - planar.state.head<2>();
    const Eigen::Matrix<double, 4, 2> gain = planar.covariance.leftCols<2>() * S_inverse;
    planar.state += gain * innovation_m;
    planar.covariance -= gain * S * gain.transpose();
    const double likelihood =
        std::exp(-0.5 * innovation_m.dot(S_inverse * innovation_m)) / std::sqrt(S.determinant());
    planar.probability *= std::max(likelihood, 1e-30);
    sum += planar.probability;
  }
  for (Planar& planar : planar_) planar.probability = std::clamp(planar.probability / sum, 1e-6, 1.0 - 1e-6);
}

void ObjectFilter::update_velocity(const Eigen::Vector2d& measured_mps, double sd_mps,
                                   const ObjectMotionConfig& config) {
  // What estimates say of their own precision leaves out what their models leave out.
  const double sd = std::hypot(sd_mps, config.velocity_sd_mps);
  double sum = 0.0;
  for (Planar& planar : planar_) {
    const Eigen::Matrix2d S =
        planar.covariance.bottomRightCorner<2, 2>() + square(sd) * Eigen::Matrix2d::Identity();
    const Eigen::Vector2d innovation_mps = measured_mps - planar.state.tail<2>();
    const Eigen::Vector2d weighted = S.inverse() * innovation_mps;
    const Eigen::Matrix<double, 4, 2> PH = planar.covariance.rightCols<2>();
    planar.state += PH * weighted;
    planar.covariance -= PH * S.inverse() * PH.transpose();
    planar.probability *=
        std::max(std::exp(-0.5 * innovation_mps.dot(weighted)) / std::sqrt(S.determinant()), 1e-30);
    sum += planar.probability;
  }
  for (Planar& planar : planar_) planar.probability = std::clamp(planar.probability / sum, 1e-6, 1.0 - 1e-6);
}

void ObjectFilter::forbid_sideways_motion(double sideways_sd_mps) {
  Planar& moving = planar_[kMoving];
  const double speed = moving.state.tail<2>().norm();
  Vector4d h;
  h << 0.0, 0.0, -std::sin(yaw_(0)), std::cos(yaw_(0));
  const double variance = square(sideways_sd_mps) + square(speed) * yaw_covariance_(0, 0);
  const Vector4d Ph = moving.covariance * h;
  const double innovation_variance = h.dot(Ph) + variance;
  moving.state -= Ph * (h.dot(moving.state) / innovation_variance);
  moving.covariance -= Ph * Ph.transpose() / innovation_variance;
}

void ObjectFilter::update_yaw(double measured_rad, double sd_rad) {
  double innovation = wrapped_angle(measured_rad - yaw_(0));
  const bool flipped = std::abs(innovation) > 0.5 * std::numbers::pi;
  if (flipped) innovation = wrapped_angle(innovation + std::numbers::pi);
  flips_ = std::clamp(flips_ + (flipped ? 1.0 : -1.0), -kMaxFlips, 1.0);
  if (flips_ > 0.0) {
    yaw_(0) = wrapped_angle(yaw_(0) + std::numbers::pi);
    flips_ = -flips_;
  }
  const double scale =
      std::max(1.0, square(innovation) / (yaw_covariance_(0, 0) + square(sd_rad)) / kRobustDistance);
  const Eigen::Vector2d gain = yaw_covariance_.col(0) / (yaw_covariance_(0, 0) + scale * square(sd_rad));
  yaw_ += gain * innovation;
  yaw_(0) = wrapped_angle(yaw_(0));
  yaw_covariance_ -= gain * yaw_covariance_.row(0).eval();
}

void ObjectFilter::turn_round_if_backwards() {
  const Planar& moving = planar_[kMoving];
  if (moving.probability < 0.9) return;
  const double ahead_mps = moving.state.tail<2>().dot(Eigen::Vector2d(std::cos(yaw_(0)), std::sin(yaw_(0))));
  if (ahead_mps > -kMinSpeedToTell_mps) return;
  yaw_(0) = wrapped_angle(yaw_(0) + std::numbers::pi);
  flips_ = -kMaxFlips;
}

ObjectFilter::Distance ObjectFilter::distance(const BoxMeasurement& measurement, double extra_sd_m) const {
  const PlacedBox& box = measurement.box;
  const Eigen::Matrix2d noise =
      oriented_covariance(box.yaw_rad, std::hypot(measurement.along_sd_m, extra_sd_m),
                          std::hypot(measurement.across_sd_m, extra_sd_m));
  Distance best;
  double least = std::numeric_limits<double>::infinity();
  for (const Planar& planar : planar_) {
    const Eigen::Matrix2d S = planar.covariance.topLeftCorner<2, 2>() + noise;
    const Eigen::Vector2d innovation_m = box.center_map_m.head<2>() - planar.state.head<2>();
    const double position = innovation_m.dot(S.inverse() * innovation_m);
    const double spread = std::log(S.determinant()) - 2.0 * std::log(planar.probability);
    if (position + spread >= least) continue;
    least = position + spread;
    best.position = position;
    best.spread = spread;
  }
  for (int i = 0; i < 3; ++i) {
    best.size +=
        square(box.size_lwh_m(i) - size_[i].value) / (size_[i].variance + square(measurement.size_sd_m(i)));
  }
  best.heading =
      square(std::sin(box.yaw_rad - yaw_(0))) / (yaw_covariance_(0, 0) + square(measurement.yaw_sd_rad));
  return best;
}

PlacedBox ObjectFilter::box() const {
  const Eigen::Vector2d center_m = planar_[kStanding].probability * planar_[kStanding].state.head<2>() +
                                   planar_[kMoving].probability * planar_[kMoving].state.head<2>();
  return {
      {center_m.x(), center_m.y(), height_.value}, {size_[0].value, size_[1].value, size_[2].value}, yaw_(0)};
}

Eigen::Vector2d ObjectFilter::mixed() const {
  return planar_[kMoving].probability * planar_[kMoving].state.tail<2>();
}

ObjectFilter::Matrix4d ObjectFilter::planar_covariance() const {
  const Vector4d mean = planar_[kStanding].probability * planar_[kStanding].state +
                        planar_[kMoving].probability * planar_[kMoving].state;
  Matrix4d covariance = Matrix4d::Zero();
  for (const Planar& planar : planar_) {
    const Vector4d apart = planar.state - mean;
    covariance += planar.probability * (planar.covariance + apart * apart.transpose());
  }
  return covariance;
}

}  // namespace mlo
