#include "mlo/mapping/displacement.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <Eigen/LU>

#include "mlo/core/robust_kernel.hpp"
#include "mlo/mapping/neighbourhood.hpp"

namespace mlo {
namespace {

// Neighbouring points of one surface err together: so many count as one.
constexpr double kPointsPerMeasurement = 4.0;

// A point within so many standard deviations lies on the map.
constexpr double kClose = 3.0;
// More points of one object are thinned: they say no more.
constexpr std::size_t kMaxPoints = 300;

std::size_t stride_of(std::size_t num_points) {
  return 1 + num_points / kMaxPoints;
}

// Steps below these change no decision.
constexpr double kSettled_m = 0.002;
constexpr double kSettled_rad = 0.001;

// Motions below these find the same neighbours.
constexpr double kRematch_m = 0.01;
constexpr double kRematch_rad = 0.005;

// Of [x y yaw].
bool is_small(const Eigen::Vector3d& motion, double max_m, double max_rad) {
  return motion.head<2>().norm() < max_m && std::abs(motion.z()) < max_rad;
}

// [x y yaw] of a motion in the plane, about the points' centre.
struct PlanarSums {
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  Eigen::Vector3d g = Eigen::Vector3d::Zero();
  double cost = 0.0;
  int count = 0;
  int close = 0;  // of those, on the map
};

void accumulate(const ShapeMatch& match, const Eigen::Vector3d& p_map, const Eigen::Vector2d& arm,
                const DynamicCheckConfig& config, PlanarSums& sums) {
  if (match.num_directions == 0) return;
  const double d2 = match.squared_distance_m2(p_map);
  if (d2 > config.gate_m * config.gate_m) return;
  if (d2 < kClose * kClose * config.point_sd_m * config.point_sd_m) ++sums.close;
  const double robust = geman_mcclure_weight(d2, config.kernel_m);
  const Eigen::Vector3d d = p_map - match.q_map.cast<double>();
  for (int i = 0; i < match.num_directions; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const Eigen::Vector3d n = match.directions[k].cast<double>();
    const Eigen::Vector3d jacobian(n.x(), n.y(), arm.x() * n.y() - arm.y() * n.x());
    const double weight = robust * static_cast<double>(match.weights[k]);
    const double residual = n.dot(d);
    sums.H += weight * jacobian * jacobian.transpose();
    sums.g += weight * residual * jacobian;
    sums.cost += weight * residual * residual;
  }
  ++sums.count;
}

ShapeMatch match(const Eigen::Vector3d& p_map, const LocalMap& map, const DynamicCheckConfig& config,
                 const RefinementConfig& shapes) {
  const NearestPoints near =
      map.nearest(p_map.cast<float>(), shapes.neighbours, static_cast<float>(config.gate_m));
  return describe(near, ExpectedShape::plane, shapes);
}

// Squared distance of a point from a surface, as a share of what counts as far (Geman and McClure): 0 on it,
// 1 where there is none.
double robust_distance(const Eigen::Vector3d& p_map, const LocalMap& surface,
                       const DynamicCheckConfig& config, const RefinementConfig& shapes) {
  const ShapeMatch found = match(p_map, surface, config, shapes);
  if (found.num_directions == 0) return 1.0;
  const double d2 = found.squared_distance_m2(p_map);
  return d2 > config.gate_m * config.gate_m ? 1.0 : d2 / (config.kernel_m * config.kernel_m + d2);
}

// Every stride-th point of an object, with what the map has around it.
class MatchedPoints {
 public:
  MatchedPoints(std::span<const Eigen::Vector3f> points_map, const LocalMap& at_rest,
                const DynamicCheckConfig& config, const RefinementConfig& shapes)
      : at_rest_(at_rest), config_(config), shapes_(shapes) {
    for (const Eigen::Vector3f& p : points_map) center_ += p.cast<double>();
    center_ /= static_cast<double>(points_map.size());
    const std::size_t stride = stride_of(points_map.size());
    for (std::size_t k = 0; k < points_map.size(); k += stride) {
      arms_.emplace_back(points_map[k].cast<double>() - center_);
    }
    matches_.resize(arms_.size());
  }

  std::size_t size() const { return arms_.size(); }
  const Eigen::Vector3d& center() const { return center_; }

  // After a motion. Matches are searched anew unless it hardly differs from that of the last search.
  PlanarSums linearize(const Eigen::Vector3d& motion) {
    const bool searches = !searched_ || !is_small(motion - *searched_, kRematch_m, kRematch_rad);
    if (searches) searched_ = motion;
    const Eigen::Matrix3d R = so3_exp({0.0, 0.0, motion.z()}).toRotationMatrix();
    PlanarSums sums;
    for (std::size_t k = 0; k < arms_.size(); ++k) {
      const Eigen::Vector3d arm = R * arms_[k];
      const Eigen::Vector3d moved = center_ + arm + Eigen::Vector3d(motion.x(), motion.y(), 0.0);
      if (searches) matches_[k] = match(moved, at_rest_, config_, shapes_);
      accumulate(matches_[k], moved, arm.head<2>(), config_, sums);
    }
    return sums;
  }

 private:
  const LocalMap& at_rest_;
  const DynamicCheckConfig& config_;
  const RefinementConfig& shapes_;
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
  std::vector<Eigen::Vector3d> arms_;  // from the centre
  std::vector<ShapeMatch> matches_;
  std::optional<Eigen::Vector3d> searched_;  // the motion of the last search
};

}  // namespace

double Displacement::sd_m() const {
  const double half_trace = 0.5 * covariance.trace();
  return std::sqrt(half_trace + std::sqrt(std::max(0.0, half_trace * half_trace - covariance.determinant())));
}

double Displacement::significance() const {
  return std::sqrt(shift_map_m.dot(covariance.inverse() * shift_map_m));
}

Displacement measure_displacement(std::span<const Eigen::Vector3f> points_map, const LocalMap& at_rest,
                                  const DynamicCheckConfig& config, const RefinementConfig& shapes) {
  Displacement result;
  if (points_map.empty()) return result;
  MatchedPoints points(points_map, at_rest, config, shapes);
  const Eigen::Vector3d prior =
      Eigen::Vector3d(config.prior_shift_sd_m, config.prior_shift_sd_m, config.prior_turn_sd_rad)
          .cwiseAbs2()
          .cwiseInverse() *
      (config.point_sd_m * config.point_sd_m * kPointsPerMeasurement);
  Eigen::Vector3d motion = Eigen::Vector3d::Zero();
  PlanarSums sums;
  for (int i = 0; i < config.iterations; ++i) {
    sums = points.linearize(motion);
    if (sums.count < config.min_points) return result;
    result.fit_after = static_cast<double>(sums.close) / static_cast<double>(points.size());
    if (i == 0) result.fit_before = result.fit_after;
    sums.H.diagonal() += prior;
    sums.g += prior.cwiseProduct(motion);
    const Eigen::Vector3d step = sums.H.ldlt().solve(sums.g);
    motion -= step;
    if (is_small(step, kSettled_m, kSettled_rad)) break;
  }
  const double variance =
      kPointsPerMeasurement * std::max(config.point_sd_m * config.point_sd_m, sums.cost / sums.count);
  result.known = true;
  result.shift_map_m = -motion.head<2>();
  result.turn_rad = -motion.z();
  result.center_map = points.center();
  result.covariance = (variance * sums.H.inverse()).topLeftCorner<2, 2>();
  return result;
}

MapFit fit_map(std::span<const Eigen::Vector3f> map_points_object, const SE3& T_map_object,
               std::span<const Eigen::Vector3f> points_map, const Displacement& displacement,
               const DynamicCheckConfig& config, const RefinementConfig& shapes) {
  constexpr double kSpacing_m = 0.05;
  LocalMapConfig fine;
  fine.min_spacing_m = kSpacing_m;
  LocalMap seen(fine);
  seen.insert(points_map);
  const SE3 turn(so3_exp({0.0, 0.0, displacement.turn_rad}), Eigen::Vector3d::Zero());
  const Eigen::Vector3d shift_m(displacement.shift_map_m.x(), displacement.shift_map_m.y(), 0.0);
  double before = 0.0;
  double after = 0.0;
  int count = 0;
  const std::size_t stride = stride_of(map_points_object.size());
  for (std::size_t k = 0; k < map_points_object.size(); k += stride) {
    const Eigen::Vector3d p = T_map_object * map_points_object[k].cast<double>();
    const Eigen::Vector3d arm = p - displacement.center_map + shift_m;
    const double here = robust_distance(p, seen, config, shapes);
    const double there = robust_distance(displacement.center_map + turn * arm, seen, config, shapes);
    if (here == 1.0 && there == 1.0) continue;  // a side that is not seen now
    before += here;
    after += there;
    ++count;
  }
  if (count == 0 || before == 0.0) return {};
  return {.misfit = before / count, .gain = (before - after) / before};
}

}  // namespace mlo
