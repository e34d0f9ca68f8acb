#include "mlo/truth/oxts_smoother.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>

#include <Eigen/Cholesky>

namespace mlo {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

// Error state: place, velocity, acceleration (world), attitude (world, acting on the left), rate (IMU).
constexpr int kSize = 15;
enum Block { kPlace = 0, kVelocity = 3, kAcceleration = 6, kAttitude = 9, kRate = 12 };
using Vector15d = Eigen::Matrix<double, kSize, 1>;
using Matrix15d = Eigen::Matrix<double, kSize, kSize>;

// A measurement: place, velocity, attitude, rate.
constexpr int kMeasured = 12;
using Vector12d = Eigen::Matrix<double, kMeasured, 1>;
using Matrix12x15d = Eigen::Matrix<double, kMeasured, kSize>;

struct State {
  Eigen::Vector3d p = Eigen::Vector3d::Zero();
  Eigen::Vector3d v = Eigen::Vector3d::Zero();
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Quaterniond R = Eigen::Quaterniond::Identity();
  Eigen::Vector3d w = Eigen::Vector3d::Zero();

  State plus(const Vector15d& d) const {
    State moved{p + d.segment<3>(kPlace), v + d.segment<3>(kVelocity), a + d.segment<3>(kAcceleration),
                so3_exp(d.segment<3>(kAttitude)) * R, w + d.segment<3>(kRate)};
    moved.R.normalize();
    return moved;
  }
  Vector15d minus(const State& other) const {
    Vector15d d;
    d << p - other.p, v - other.v, a - other.a, so3_log(R * other.R.conjugate()), w - other.w;
    return d;
  }
};

struct Measurement {
  State state;  // without acceleration
  Vector12d sigma = Vector12d::Zero();
};

// One time at which there is a record, or a pose is wanted.
struct Node {
  double stamp_s = 0.0;
  std::optional<std::size_t> record;
  std::optional<std::size_t> query;

  State predicted, filtered;
  Matrix15d P_predicted = Matrix15d::Zero();
  Matrix15d P_filtered = Matrix15d::Zero();
  Matrix15d F = Matrix15d::Identity();  // from the node before
};

std::vector<Measurement> measurements(std::span<const OxtsRecord> records,
                                      const OxtsSmootherOptions& options) {
  const std::vector<SE3> poses = oxts_poses(records);
  std::vector<Measurement> result(records.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    const OxtsRecord::Motion motion = records[i].motion.value_or(OxtsRecord::Motion{});
    Measurement& m = result[i];
    m.state.p = poses[i].translation();
    m.state.R = poses[i].rotation();
    m.state.v = motion.velocity_enu_m_s;
    m.state.w = motion.rate_imu_rad_s;
    const double place = std::max(motion.position_accuracy_m, options.min_position_accuracy_m);
    const double velocity = std::max(motion.velocity_accuracy_m_s, options.min_velocity_accuracy_m_s);
    const double tilt = options.roll_pitch_deg * kRadPerDeg;
    const double rate = options.rate_deg_s * kRadPerDeg;
    m.sigma << place, place, place, velocity, velocity, velocity, tilt, tilt,
        options.heading_deg * kRadPerDeg, rate, rate, rate;
  }
  return result;
}

std::vector<Node> nodes_in_time(std::span<const OxtsRecord> records, std::span<const double> stamps_s) {
  std::vector<Node> nodes(records.size() + stamps_s.size());
  for (std::size_t i = 0; i < records.size(); ++i) {
    nodes[i].stamp_s = records[i].stamp_s.value_or(0.0);
    nodes[i].record = i;
  }
  for (std::size_t i = 0; i < stamps_s.size(); ++i) {
    Node& node = nodes[records.size() + i];
    node.stamp_s = stamps_s[i];
    node.query = i;
  }
  std::stable_sort(nodes.begin(), nodes.end(),
                   [](const Node& a, const Node& b) { return a.stamp_s < b.stamp_s; });
  return nodes;
}

State predict(const State& from, double dt) {
  State to = from;
  to.p += from.v * dt + 0.5 * dt * dt * from.a;
  to.v += from.a * dt;
  to.R = (from.R * so3_exp(from.w * dt)).normalized();
  return to;
}

Eigen::Matrix3d mean_rotation(const State& from, double dt) {
  return (from.R * so3_exp(0.5 * dt * from.w)).toRotationMatrix();
}

Matrix15d transition(const State& from, double dt) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  Matrix15d F = Matrix15d::Identity();
  F.block<3, 3>(kPlace, kVelocity) = dt * I;
  F.block<3, 3>(kPlace, kAcceleration) = 0.5 * dt * dt * I;
  F.block<3, 3>(kVelocity, kAcceleration) = dt * I;
  F.block<3, 3>(kAttitude, kRate) = dt * mean_rotation(from, dt);
  return F;
}

// White noise of unit density on the last derivative, integrated.
Matrix15d process_noise(const State& from, double dt, const OxtsSmootherOptions& options) {
  const Eigen::Matrix3d I = Eigen::Matrix3d::Identity();
  const double qa = std::pow(options.acceleration_walk_m_s2, 2);
  const double qw = std::pow(options.rate_walk_deg_s * kRadPerDeg, 2);
  const double dt2 = dt * dt;
  const double dt3 = dt2 * dt;
  Matrix15d Q = Matrix15d::Zero();
  Q.block<3, 3>(kPlace, kPlace) = qa * dt3 * dt2 / 20.0 * I;
  Q.block<3, 3>(kPlace, kVelocity) = Q.block<3, 3>(kVelocity, kPlace) = qa * dt2 * dt2 / 8.0 * I;
  Q.block<3, 3>(kPlace, kAcceleration) = Q.block<3, 3>(kAcceleration, kPlace) = qa * dt3 / 6.0 * I;
  Q.block<3, 3>(kVelocity, kVelocity) = qa * dt3 / 3.0 * I;
  Q.block<3, 3>(kVelocity, kAcceleration) = Q.block<3, 3>(kAcceleration, kVelocity) = qa * dt2 / 2.0 * I;
  Q.block<3, 3>(kAcceleration, kAcceleration) = qa * dt * I;
  const Eigen::Matrix3d R = mean_rotation(from, dt);
  Q.block<3, 3>(kAttitude, kAttitude) = qw * dt3 / 3.0 * I;
  Q.block<3, 3>(kAttitude, kRate) = qw * dt2 / 2.0 * R;
  Q.block<3, 3>(kRate, kAttitude) = qw * dt2 / 2.0 * R.transpose();
  Q.block<3, 3>(kRate, kRate) = qw * dt * I;
  return Q;
}

// Nothing is known but what the first record says, and that only roughly.
Matrix15d wide_covariance() {
  Vector15d sigma;
  sigma << Eigen::Vector3d::Constant(100.0), Eigen::Vector3d::Constant(50.0), Eigen::Vector3d::Constant(5.0),
      Eigen::Vector3d::Constant(0.5), Eigen::Vector3d::Constant(1.0);
  return sigma.cwiseAbs2().asDiagonal();
}

// All of the state but the acceleration is measured.
Matrix12x15d measurement_matrix() {
  Matrix12x15d H = Matrix12x15d::Zero();
  H.block<3, 3>(0, kPlace).setIdentity();
  H.block<3, 3>(3, kVelocity).setIdentity();
  H.block<3, 3>(6, kAttitude).setIdentity();
  H.block<3, 3>(9, kRate).setIdentity();
  return H;
}

void update(Node& node, const Measurement& measurement) {
  const Matrix12x15d H = measurement_matrix();
  const Matrix15d& P = node.P_predicted;
  const Eigen::Matrix<double, kMeasured, kMeasured> N = measurement.sigma.cwiseAbs2().asDiagonal();
  const Eigen::Matrix<double, kMeasured, kMeasured> S = H * P * H.transpose() + N;
  const Eigen::Matrix<double, kSize, kMeasured> K = S.ldlt().solve(H * P).transpose();
  node.filtered = node.predicted.plus(K * (H * measurement.state.minus(node.predicted)));
  const Matrix15d I_KH = Matrix15d::Identity() - K * H;
  node.P_filtered = I_KH * P * I_KH.transpose() + K * N * K.transpose();  // stays symmetric and positive
}

void filter(std::vector<Node>& nodes, const std::vector<Measurement>& measured,
            const OxtsSmootherOptions& options) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    Node& node = nodes[i];
    if (i == 0) {
      node.predicted = measured.front().state;
      node.P_predicted = wide_covariance();
    } else {
      const Node& before = nodes[i - 1];
      const double dt = node.stamp_s - before.stamp_s;
      node.predicted = predict(before.filtered, dt);
      node.F = transition(before.filtered, dt);
      node.P_predicted =
          node.F * before.P_filtered * node.F.transpose() + process_noise(before.filtered, dt, options);
    }
    node.filtered = node.predicted;
    node.P_filtered = node.P_predicted;
    if (node.record) update(node, measured[*node.record]);
  }
}

// Backwards; afterwards `filtered` holds what all records say.
void smooth(std::vector<Node>& nodes) {
  for (std::size_t i = nodes.size(); i-- > 1;) {
    const Node& next = nodes[i];
    Node& node = nodes[i - 1];
    const Matrix15d gain = next.P_predicted.ldlt().solve(next.F * node.P_filtered).transpose();
    node.filtered = node.filtered.plus(gain * next.filtered.minus(next.predicted));
    node.P_filtered += gain * (next.P_filtered - next.P_predicted) * gain.transpose();
  }
}

SmoothedPose::Matrix6d pose_covariance(const Matrix15d& P) {
  SmoothedPose::Matrix6d covariance;
  covariance << P.block<3, 3>(kPlace, kPlace), P.block<3, 3>(kPlace, kAttitude),
      P.block<3, 3>(kAttitude, kPlace), P.block<3, 3>(kAttitude, kAttitude);
  return 0.5 * (covariance + covariance.transpose());
}

}  // namespace

std::vector<SmoothedPose> smooth_oxts(std::span<const OxtsRecord> records, std::span<const double> stamps_s,
                                      const OxtsSmootherOptions& options) {
  std::vector<SmoothedPose> poses(stamps_s.size());
  if (records.empty()) return poses;
  std::vector<Node> nodes = nodes_in_time(records, stamps_s);
  filter(nodes, measurements(records, options), options);
  smooth(nodes);
  for (const Node& node : nodes) {
    if (!node.query) continue;
    poses[*node.query] = {.stamp_s = node.stamp_s,
                          .T_world_imu = SE3(node.filtered.R, node.filtered.p),
                          .velocity_world_m_s = node.filtered.v,
                          .covariance = pose_covariance(node.P_filtered)};
  }
  return poses;
}

}  // namespace mlo
