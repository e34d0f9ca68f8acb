#pragma once

#include <Eigen/Core>

#include "mlo/core/box.hpp"
#include "mlo/tracking/config.hpp"
#include "mlo/tracking/placed_box.hpp"

namespace mlo {

/// Log-odds of a confidence, cut to [-2, 12]: beyond, detectors' scores mean nothing more.
double confidence_logit(double confidence);

/// A box that was measured, and how well (standard deviations).
struct BoxMeasurement {
  PlacedBox box;
  double along_sd_m = 0.0;   ///< of the centre, along the heading
  double across_sd_m = 0.0;  ///< and across
  double height_sd_m = 0.0;
  double yaw_sd_rad = 0.0;
  Eigen::Vector3d size_sd_m = Eigen::Vector3d::Zero();
};

/// A detection in the map frame with the noise that its confidence stands for.
BoxMeasurement measure(const Detection& detection, const SE3& T_map_lidar, const BoxNoiseConfig& config);

/// Estimate of an object's box and motion in the map frame from boxes: a Kalman filter with two models
/// of the planar motion that mix (interacting multiple models: Blom and Bar-Shalom, IEEE TAC 1988), standing
/// and moving with nearly constant velocity, and independent filters for height, heading with turn rate and
/// size.
class ObjectFilter {
 public:
  using Vector4d = Eigen::Matrix<double, 4, 1>;
  using Matrix4d = Eigen::Matrix<double, 4, 4>;

  /// To be read from an archive.
  ObjectFilter() = default;
  /// Starts from one measurement with unknown velocity.
  /// @param wheeled  moves along its heading only
  ObjectFilter(const BoxMeasurement& first, bool wheeled, const ObjectMotionConfig& config);

  void predict(double dt_s, const ObjectMotionConfig& config);

  /// A heading nearer to the opposite of the estimate than to the estimate counts as flipped and is turned
  /// round; the estimate itself turns round when most measurements say so, or when it moves backwards.
  void update(const BoxMeasurement& measurement, const ObjectMotionConfig& config);

  /// A velocity that was measured besides the boxes, with the standard deviation of each component.
  void update_velocity(const Eigen::Vector2d& measured_mps, double sd_mps, const ObjectMotionConfig& config);

  /// What sets this object and a measurement apart.
  struct Distance {
    double position = 0.0;  ///< squared distance in the plane over its variance (the likelier model's)
    double spread =
        0.0;            ///< log of that variance's determinant, less twice the log of the model's probability
    double size = 0.0;  ///< squared difference of sizes over the variance
    double heading = 0.0;  ///< squared sine of the difference of headings over the variance
  };
  /// @param extra_sd_m  added to the position's uncertainty
  Distance distance(const BoxMeasurement& measurement, double extra_sd_m) const;

  PlacedBox box() const;
  Eigen::Vector2d velocity_mps() const { return mixed().head<2>(); }
  double turn_rate_radps() const { return yaw_(1); }
  /// Probability that the object moves.
  double moving_probability() const { return planar_[kMoving].probability; }
  /// Of [x; y; vx; vy] in the map frame, both models together.
  Matrix4d planar_covariance() const;
  /// Of [yaw; turn rate].
  const Eigen::Matrix2d& yaw_covariance() const { return yaw_covariance_; }
  double height_variance_m2() const { return height_.variance; }

  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.planar_, self.height_, self.size_, self.yaw_, self.yaw_covariance_, self.flips_,
          self.wheeled_);
  }

 private:
  static constexpr int kStanding = 0;
  static constexpr int kMoving = 1;

  struct Planar {
    Vector4d state = Vector4d::Zero();  ///< x, y [m], vx, vy [m/s]
    Matrix4d covariance = Matrix4d::Zero();
    double probability = 0.5;
    static void archive(auto& self, auto& bytes) { bytes(self.state, self.covariance, self.probability); }
  };
  struct Scalar {
    double value = 0.0;
    double variance = 0.0;
    void update(double measured, double measured_variance);
    static void archive(auto& self, auto& bytes) { bytes(self.value, self.variance); }
  };

  Eigen::Vector2d mixed() const;
  void mix(const ObjectMotionConfig& config);
  void update_planar(const Eigen::Vector2d& measured_m, const Eigen::Matrix2d& noise);
  void forbid_sideways_motion(double sideways_sd_mps);
  void update_yaw(double measured_rad, double sd_rad);
  void turn_round_if_backwards();

  Planar planar_[2];
  Scalar height_;
  Scalar size_[3];
  Eigen::Vector2d yaw_ = Eigen::Vector2d::Zero();  ///< heading [rad], turn rate [rad/s]
  Eigen::Matrix2d yaw_covariance_ = Eigen::Matrix2d::Identity();
  double flips_ = 0.0;  ///< weight of measurements that point backwards, less that of the others
  bool wheeled_ = false;
};

}  // namespace mlo
