#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "mlo/truth/oxts_smoother.hpp"

namespace mlo {
namespace {

constexpr double kPeriod_s = 0.1;
constexpr double kRadPerDeg = std::numbers::pi / 180.0;
constexpr double kEarthRadius_m = 6378137.0;
constexpr double kLatitude_deg = 49.0;

struct Truth {
  SE3 T_world_imu;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d rate = Eigen::Vector3d::Zero();
};

struct Noise {
  double place_m = 0.3;
  double velocity_m_s = 0.05;
};

class Random {
 public:
  explicit Random(unsigned seed) : rng_(seed) {}
  double normal() { return distribution_(rng_); }
  Eigen::Vector3d normal3() { return {normal(), normal(), normal()}; }

 private:
  std::mt19937 rng_;
  std::normal_distribution<double> distribution_;
};

// A record of the true state with errors drawn from what it claims. A few hundred metres around the origin,
// where the projection is a scale.
OxtsRecord record_of(const Truth& truth, double stamp_s, const Noise& noise,
                     const OxtsSmootherOptions& options, Random& random) {
  const Eigen::Vector3d p = truth.T_world_imu.translation() + noise.place_m * random.normal3();
  const double scale = std::cos(kLatitude_deg * kRadPerDeg) * kEarthRadius_m;
  const double north_origin = std::log(std::tan((90.0 + kLatitude_deg) * kRadPerDeg / 2.0));
  OxtsRecord record;
  record.stamp_s = stamp_s;
  record.latitude_deg =
      (2.0 * std::atan(std::exp(p.y() / scale + north_origin)) - std::numbers::pi / 2.0) / kRadPerDeg;
  record.longitude_deg = p.x() / scale / kRadPerDeg;
  record.altitude_m = p.z();
  const double tilt = options.roll_pitch_deg * kRadPerDeg;
  const Eigen::Vector3d turn =
      random.normal3().cwiseProduct(Eigen::Vector3d(tilt, tilt, options.heading_deg * kRadPerDeg));
  const Eigen::Matrix3d R = (so3_exp(turn) * truth.T_world_imu.rotation()).toRotationMatrix();
  record.roll_pitch_yaw_rad = {std::atan2(R(2, 1), R(2, 2)), std::asin(-R(2, 0)),
                               std::atan2(R(1, 0), R(0, 0))};
  record.motion =
      OxtsRecord::Motion{.velocity_enu_m_s = truth.velocity + noise.velocity_m_s * random.normal3(),
                         .rate_imu_rad_s = truth.rate + options.rate_deg_s * kRadPerDeg * random.normal3(),
                         .position_accuracy_m = noise.place_m,
                         .velocity_accuracy_m_s = noise.velocity_m_s};
  return record;
}

// The smoother's world is about the first record: moves the pose back into the true one.
SE3 in_true_world(const SE3& T, const OxtsRecord& first) {
  const double scale = std::cos(first.latitude_deg * kRadPerDeg) * kEarthRadius_m;
  const auto north = [&](double latitude_deg) {
    return scale * std::log(std::tan((90.0 + latitude_deg) * kRadPerDeg / 2.0));
  };
  const Eigen::Vector3d origin(scale * first.longitude_deg * kRadPerDeg,
                               north(first.latitude_deg) - north(kLatitude_deg), first.altitude_m);
  return {T.rotation(), T.translation() + origin};
}

// A drive whose acceleration and turn rate walk at random, as the filter supposes.
std::vector<Truth> random_drive(std::size_t count, const OxtsSmootherOptions& options, Random& random) {
  constexpr int kSubSteps = 50;
  const double dt = kPeriod_s / kSubSteps;
  std::vector<Truth> drive;
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d v(8.0, 2.0, 0.0);
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d w = Eigen::Vector3d::Zero();
  Eigen::Quaterniond R = so3_exp({0.0, 0.0, 0.4});
  for (std::size_t i = 0; i < count; ++i) {
    drive.push_back({SE3(R, p), v, w});
    for (int step = 0; step < kSubSteps; ++step) {
      p += dt * v + 0.5 * dt * dt * a;
      v += dt * a;
      R = (R * so3_exp(dt * w)).normalized();
      a += options.acceleration_walk_m_s2 * std::sqrt(dt) * random.normal3();
      w += options.rate_walk_deg_s * kRadPerDeg * std::sqrt(dt) * random.normal3();
    }
  }
  return drive;
}

// A smooth drive: a bend with changing speed, and a nodding car.
Truth bend(double t) {
  const auto place = [](double s) {
    return Eigen::Vector3d(40.0 * std::sin(0.2 * s), 40.0 - 40.0 * std::cos(0.2 * s),
                           0.5 * std::sin(0.3 * s));
  };
  const auto attitude = [](double s) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(0.2 * s, Eigen::Vector3d::UnitZ()) *
                              Eigen::AngleAxisd(0.01 * std::sin(2.0 * s), Eigen::Vector3d::UnitY()));
  };
  constexpr double kStep = 1e-4;
  return {SE3(attitude(t), place(t)), (place(t + kStep) - place(t - kStep)) / (2.0 * kStep),
          so3_log(attitude(t - kStep).conjugate() * attitude(t + kStep)) / (2.0 * kStep)};
}

struct Case {
  std::vector<OxtsRecord> records;
  std::vector<double> stamps_s;
};

Case records_of(const std::vector<Truth>& drive, const Noise& noise, const OxtsSmootherOptions& options,
                Random& random) {
  Case result;
  for (std::size_t i = 0; i < drive.size(); ++i) {
    result.stamps_s.push_back(kPeriod_s * static_cast<double>(i));
    result.records.push_back(record_of(drive[i], result.stamps_s.back(), noise, options, random));
  }
  return result;
}

SE3::Tangent pose_error(const SE3& truth, const SE3& estimate) {
  SE3::Tangent error;
  error << truth.translation() - estimate.translation(),
      so3_log(truth.rotation() * estimate.rotation().conjugate());
  return error;
}

// Mean of e^T P^-1 e over many drives: its expectation is the number of degrees of freedom.
TEST(OxtsSmoother, ErrorsAreAsLargeAsTheCovarianceSays) {
  const OxtsSmootherOptions options;
  double sum = 0.0;
  std::size_t count = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    Random random(seed);
    const std::vector<Truth> drive = random_drive(60, options, random);
    const Case data = records_of(drive, {}, options, random);
    const std::vector<SmoothedPose> poses = smooth_oxts(data.records, data.stamps_s, options);
    for (std::size_t i = 0; i < poses.size(); i += 5) {
      const SE3::Tangent error =
          pose_error(drive[i].T_world_imu, in_true_world(poses[i].T_world_imu, data.records.front()));
      sum += error.dot(poses[i].covariance.ldlt().solve(error));
      ++count;
    }
  }
  EXPECT_NEAR(sum / static_cast<double>(count), 6.0, 0.6);
}

struct Rms {
  double place_m, step_m, turn_rad;
};

Rms rms_of(const std::vector<SE3>& estimate, const std::function<SE3(std::size_t)>& truth) {
  Rms rms{0.0, 0.0, 0.0};
  for (std::size_t i = 1; i < estimate.size(); ++i) {
    const SE3::Tangent error = pose_error(truth(i), estimate[i]);
    const SE3 step =
        (truth(i - 1).inverse() * truth(i)).inverse() * (estimate[i - 1].inverse() * estimate[i]);
    rms.place_m += error.head<3>().squaredNorm();
    rms.turn_rad += error.tail<3>().squaredNorm();
    rms.step_m += step.translation().squaredNorm();
  }
  const auto count = static_cast<double>(estimate.size() - 1);
  return {std::sqrt(rms.place_m / count), std::sqrt(rms.step_m / count), std::sqrt(rms.turn_rad / count)};
}

TEST(OxtsSmoother, IsCloserToTheTruthThanTheRecords) {
  const OxtsSmootherOptions options;
  Random random(3);
  std::vector<Truth> drive;
  for (int i = 0; i < 200; ++i) drive.push_back(bend(kPeriod_s * i));
  const Case data = records_of(drive, {}, options, random);
  std::vector<SE3> raw;
  for (const SE3& pose : oxts_poses(data.records)) raw.push_back(in_true_world(pose, data.records.front()));
  std::vector<SE3> smoothed;
  for (const SmoothedPose& pose : smooth_oxts(data.records, data.stamps_s, options)) {
    smoothed.push_back(in_true_world(pose.T_world_imu, data.records.front()));
  }
  const auto truth = [&](std::size_t i) { return drive[i].T_world_imu; };
  const Rms of_raw = rms_of(raw, truth);
  const Rms of_smoothed = rms_of(smoothed, truth);
  EXPECT_LT(of_smoothed.place_m, 0.4 * of_raw.place_m);
  EXPECT_LT(of_smoothed.step_m, 0.05 * of_raw.step_m);
  EXPECT_LT(of_smoothed.turn_rad, 0.85 * of_raw.turn_rad);
}

TEST(OxtsSmoother, GivesPosesBetweenAndBeyondTheRecords) {
  const OxtsSmootherOptions options;
  Random random(5);
  std::vector<Truth> drive;
  for (int i = 0; i < 60; ++i) drive.push_back(bend(kPeriod_s * i));
  const Case data = records_of(drive, {.place_m = 0.01, .velocity_m_s = 0.01}, options, random);
  const std::vector<double> wanted_s{3.05, -0.04, 5.94, 2.0};
  const std::vector<SmoothedPose> poses = smooth_oxts(data.records, wanted_s, options);
  ASSERT_EQ(poses.size(), 4U);
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(poses[i].stamp_s, wanted_s[i]);
    const SE3::Tangent error =
        pose_error(bend(wanted_s[i]).T_world_imu, in_true_world(poses[i].T_world_imu, data.records.front()));
    EXPECT_LT(error.head<3>().norm(), 0.03) << wanted_s[i];
    EXPECT_LT(error.tail<3>().norm(), 0.005) << wanted_s[i];
  }
  EXPECT_GT(poses[1].covariance.trace(), poses[3].covariance.trace());  // less is known beyond the ends
}

TEST(OxtsSmoother, ABadSatelliteFixIsBridged) {
  // For 3 s the records say themselves that their places are useless.
  const OxtsSmootherOptions options;
  Random random(7);
  std::vector<Truth> drive;
  for (int i = 0; i < 100; ++i) drive.push_back(bend(kPeriod_s * i));
  Case data = records_of(drive, {.place_m = 0.02, .velocity_m_s = 0.02}, options, random);
  for (std::size_t i = 40; i < 70; ++i) {
    data.records[i].longitude_deg += 1e-3;  // 73 m
    data.records[i].motion->position_accuracy_m = 1000.0;
  }
  const std::vector<SmoothedPose> poses = smooth_oxts(data.records, data.stamps_s, options);
  const SE3 middle = in_true_world(poses[55].T_world_imu, data.records.front());
  EXPECT_LT((middle.translation() - drive[55].T_world_imu.translation()).norm(), 0.3);
  EXPECT_GT(poses[55].covariance(0, 0), 2.0 * poses[20].covariance(0, 0));
}

TEST(OxtsSmoother, NoneAndOne) {
  EXPECT_TRUE(smooth_oxts({}, {}).empty());
  EXPECT_EQ(smooth_oxts({}, std::vector<double>{1.0}).size(), 1U);
  Random random(1);
  const std::vector<OxtsRecord> one{record_of(bend(0.0), 0.0, {}, {}, random)};
  EXPECT_TRUE(smooth_oxts(one, {}).empty());
  const std::vector<SmoothedPose> poses = smooth_oxts(one, std::vector<double>{0.0, 0.1});
  EXPECT_TRUE(poses[0].T_world_imu.is_finite());
  EXPECT_NEAR(poses[0].T_world_imu.translation().norm(), 0.0, 1e-9);
  EXPECT_NEAR(std::sqrt(poses[0].covariance(0, 0)), 0.3, 0.01);
  EXPECT_TRUE(poses[1].T_world_imu.is_finite());
}

}  // namespace
}  // namespace mlo
