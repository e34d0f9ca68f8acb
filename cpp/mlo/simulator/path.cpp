#include "mlo/simulator/path.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mlo::simulator {

Eigen::Vector2d PathPoint::ahead() const {
  return {std::cos(heading_rad), std::sin(heading_rad)};
}
Eigen::Vector2d PathPoint::left() const {
  return {-std::sin(heading_rad), std::cos(heading_rad)};
}

namespace {

/// Curvature at every step, averaged over a window so that it changes gradually.
std::vector<double> eased_curvature(const std::vector<PathPiece>& pieces, double ease_m, double step_m) {
  std::vector<double> sharp;
  for (const PathPiece& piece : pieces) {
    const auto steps = static_cast<std::size_t>(std::lround(piece.length_m / step_m));
    sharp.insert(sharp.end(), steps, piece.curvature_per_m);
  }
  const int half = std::max(0, static_cast<int>(std::lround(0.5 * ease_m / step_m)));
  const int count = static_cast<int>(sharp.size());
  std::vector<double> eased(sharp.size());
  for (int i = 0; i < count; ++i) {
    double sum = 0.0;
    for (int j = i - half; j <= i + half; ++j) {
      sum += sharp[static_cast<std::size_t>(std::clamp(j, 0, count - 1))];
    }
    eased[static_cast<std::size_t>(i)] = sum / (2 * half + 1);
  }
  return eased;
}

}  // namespace

Path::Path(const PathPoint& start, const std::vector<PathPiece>& pieces, double ease_m) {
  std::vector<PathPoint> samples{start};
  for (const double curvature : eased_curvature(pieces, ease_m, kStep_m)) {
    PathPoint next = samples.back();
    samples.back().curvature_per_m = curvature;
    const double middle = next.heading_rad + 0.5 * kStep_m * curvature;
    next.p_world += kStep_m * Eigen::Vector2d(std::cos(middle), std::sin(middle));
    next.heading_rad += kStep_m * curvature;
    next.curvature_per_m = curvature;
    samples.push_back(next);
  }
  *this = Path(std::move(samples));
}

Path::Path(std::vector<PathPoint> samples) : samples_(std::move(samples)) {
  double s = 0.0;
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    if (i > 0) s += (samples_[i].p_world - samples_[i - 1].p_world).norm();
    s_m_.push_back(s);
  }
}

double Path::length_m() const {
  return s_m_.empty() ? 0.0 : s_m_.back();
}

PathPoint Path::at(double s_m) const {
  if (samples_.empty()) return {};
  if (s_m <= 0.0 || s_m >= length_m() || samples_.size() == 1) {
    PathPoint end = s_m <= 0.0 ? samples_.front() : samples_.back();
    end.p_world += (s_m <= 0.0 ? s_m : s_m - length_m()) * end.ahead();
    return end;
  }
  const auto above = std::upper_bound(s_m_.begin(), s_m_.end(), s_m);
  const auto i = static_cast<std::size_t>(above - s_m_.begin() - 1);
  const PathPoint& a = samples_[i];
  const PathPoint& b = samples_[i + 1];
  const double h = s_m_[i + 1] - s_m_[i];
  const double u = (s_m - s_m_[i]) / h;
  // cubic Hermite: the tangents are the headings
  PathPoint point;
  point.p_world = (1 + 2 * u) * (1 - u) * (1 - u) * a.p_world + u * (1 - u) * (1 - u) * h * a.ahead() +
                  u * u * (3 - 2 * u) * b.p_world + u * u * (u - 1) * h * b.ahead();
  point.heading_rad = (1 - u) * a.heading_rad + u * b.heading_rad;
  point.curvature_per_m = (1 - u) * a.curvature_per_m + u * b.curvature_per_m;
  return point;
}

Path Path::offset(double left_m) const {
  std::vector<PathPoint> shifted = samples_;
  for (PathPoint& point : shifted) {
    point.p_world += left_m * point.left();
    point.curvature_per_m /= 1.0 - left_m * point.curvature_per_m;
  }
  return Path(std::move(shifted));
}

Path Path::reversed() const {
  std::vector<PathPoint> back(samples_.rbegin(), samples_.rend());
  for (PathPoint& point : back) {
    point.heading_rad += std::numbers::pi;
    point.curvature_per_m = -point.curvature_per_m;
  }
  return Path(std::move(back));
}

Path Path::part(double from_m, double to_m) const {
  const auto steps = std::max<std::size_t>(1, static_cast<std::size_t>(std::ceil((to_m - from_m) / kStep_m)));
  std::vector<PathPoint> samples;
  for (std::size_t i = 0; i <= steps; ++i) {
    samples.push_back(at(from_m + (to_m - from_m) * static_cast<double>(i) / static_cast<double>(steps)));
  }
  return Path(std::move(samples));
}

Path straight(const Eigen::Vector2d& from, double heading_rad, double length_m) {
  return Path({.p_world = from, .heading_rad = heading_rad}, {{length_m, 0.0}}, 0.0);
}

}  // namespace mlo::simulator
