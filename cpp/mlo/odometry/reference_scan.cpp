#include "mlo/odometry/reference_scan.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <nanoflann.hpp>

#include "mlo/core/azimuth.hpp"
#include "mlo/core/kd_tree_points.hpp"
#include "mlo/core/parallel.hpp"
#include "mlo/odometry/thinning.hpp"

namespace mlo {
namespace {

using Cloud = KdTreePoints<std::span<const Eigen::Vector3f>>;
using KdTree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Cloud>, Cloud, 3, std::uint32_t>;

constexpr std::size_t kLeafSize = 16;

// Result set of a search for the nearest few within a radius; of equally near points the lower index wins.
class NearestWithin {
 public:
  struct Hit {
    float squared;
    std::uint32_t index;
    bool operator<(const Hit& other) const {
      return squared < other.squared || (squared == other.squared && index < other.index);
    }
  };

  NearestWithin(std::size_t capacity, float max_squared) : capacity_(capacity), max_squared_(max_squared) {
    hits_.reserve(capacity + 1);
  }
  const std::vector<Hit>& hits() const { return hits_; }

  // The interface that nanoflann calls.
  std::size_t size() const { return hits_.size(); }
  bool full() const { return true; }
  float worstDist() const { return hits_.size() < capacity_ ? max_squared_ : hits_.back().squared; }
  bool addPoint(float squared, std::uint32_t index) {
    if (squared >= max_squared_) return true;
    const Hit hit{squared, index};
    hits_.insert(std::upper_bound(hits_.begin(), hits_.end(), hit), hit);
    if (hits_.size() > capacity_) hits_.pop_back();
    return true;
  }

 private:
  std::size_t capacity_;
  float max_squared_;
  std::vector<Hit> hits_;
};

// The single nearest point within a radius, without memory of its own: the search that is done most.
class SingleNearest {
 public:
  explicit SingleNearest(float max_squared) : squared_(max_squared) {}
  std::optional<std::size_t> index() const { return index_; }

  // The interface that nanoflann calls.
  std::size_t size() const { return index_ ? 1 : 0; }
  bool full() const { return true; }
  float worstDist() const { return squared_; }
  bool addPoint(float squared, std::uint32_t index) {
    if (squared < squared_ || (index_ && squared == squared_ && index < *index_)) {
      squared_ = squared;
      index_ = index;
    }
    return true;
  }

 private:
  float squared_;
  std::optional<std::size_t> index_;
};

struct Placed {
  Eigen::Vector3f p;
  float azimuth;
  std::uint16_t ring;
};

std::vector<Placed> place(const std::vector<FeaturePoint>& candidates, const SweepMotion& motion,
                          std::size_t max_points) {
  std::vector<Placed> placed;
  for (const FeaturePoint& candidate : thinned(candidates, max_points)) {
    const Eigen::Vector3f p =
        motion.undistort(candidate.p_lidar.cast<double>(), candidate.sweep_fraction).cast<float>();
    placed.push_back({p, azimuth_rad(p.x(), p.y()), candidate.ring});
  }
  std::stable_sort(placed.begin(), placed.end(), [](const Placed& a, const Placed& b) {
    return a.ring < b.ring || (a.ring == b.ring && a.azimuth < b.azimuth);
  });
  return placed;
}

}  // namespace

// Refers to the points by a view: moving a vector keeps its elements where they are.
struct CandidateSet::Tree {
  explicit Tree(std::span<const Eigen::Vector3f> points)
      : cloud{points}, index(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}
  Cloud cloud;
  KdTree index;
};

CandidateSet::CandidateSet() = default;
CandidateSet::~CandidateSet() = default;
CandidateSet::CandidateSet(CandidateSet&&) noexcept = default;
CandidateSet& CandidateSet::operator=(CandidateSet&&) noexcept = default;

CandidateSet::CandidateSet(const std::vector<FeaturePoint>& candidates, const SweepMotion& motion,
                           std::size_t max_points) {
  for (const Placed& placed : place(candidates, motion, max_points)) {
    if (placed.ring != Point::kNoRing) {
      while (ring_begin_.size() <= placed.ring) ring_begin_.push_back(points_.size());
    }
    points_.push_back(placed.p);
    rings_.push_back(placed.ring);
    azimuths_.push_back(placed.azimuth);
  }
  const auto known = std::find(rings_.begin(), rings_.end(), Point::kNoRing);
  ring_begin_.push_back(static_cast<std::size_t>(known - rings_.begin()));
  build_tree();
}

void CandidateSet::build_tree() {
  tree_ = points_.empty() ? nullptr : std::make_unique<const Tree>(points_);
}

std::optional<std::size_t> CandidateSet::nearest(const Eigen::Vector3d& p, double max_distance_m) const {
  if (!tree_ || !p.allFinite()) return std::nullopt;
  const Eigen::Vector3f query = p.cast<float>();
  SingleNearest result(static_cast<float>(max_distance_m * max_distance_m));
  tree_->index.findNeighbors(result, query.data(), nanoflann::SearchParams());
  return result.index();
}

std::vector<std::size_t> CandidateSet::nearest(const Eigen::Vector3d& p, std::size_t count,
                                               double max_distance_m) const {
  std::vector<std::size_t> indices;
  if (!tree_ || count == 0 || !p.allFinite()) return indices;
  const Eigen::Vector3f query = p.cast<float>();
  NearestWithin result(count, static_cast<float>(max_distance_m * max_distance_m));
  tree_->index.findNeighbors(result, query.data(), nanoflann::SearchParams());
  for (const NearestWithin::Hit& hit : result.hits()) indices.push_back(hit.index);
  return indices;
}

ReferenceScan make_reference_scan(const Percept& percept, const SweepMotion& motion,
                                  std::size_t max_candidates) {
  ReferenceScan reference;
  parallel_invoke(
      [&] {
        reference.ground = {percept.ground.candidates, motion, max_candidates};
      },
      [&] {
        reference.edge = {percept.edge.candidates, motion, max_candidates};
      },
      [&] {
        reference.surface = {percept.surface.candidates, motion, max_candidates};
      });
  return reference;
}

}  // namespace mlo
