#include "mlo/network/point_operations.hpp"

#include <algorithm>
#include <limits>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

constexpr Eigen::Index kBlock = 1024;

using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;  // of bounded size: on the stack

struct Farthest {
  float distance = -1.0F;
  Eigen::Index index = 0;
};

// Lowers the distances of a block of points to those to the point just chosen, and finds the farthest.
Farthest lower_distances(const Eigen::MatrixXf& points, const Eigen::RowVectorXf& chosen, Eigen::Index begin,
                         Eigen::ArrayXf& nearest) {
  const Eigen::Index count = std::min(kBlock, points.rows() - begin);
  Block squared = Block::Zero(count);
  for (Eigen::Index column = 0; column < points.cols(); ++column) {
    squared += (points.col(column).segment(begin, count).array() - chosen[column]).square();
  }
  auto distances = nearest.segment(begin, count);
  distances = distances.min(squared);
  const float largest = distances.maxCoeff();
  Eigen::Index first = 0;
  while (distances[first] != largest) ++first;
  return {largest, begin + first};
}

// The first neighbours of one centre.
std::size_t find_neighbors(const Eigen::Matrix<float, Eigen::Dynamic, 3>& points,
                           const Eigen::Vector3f& center, const BallQuery& query, std::uint32_t* slots) {
  const float outer = query.radius_m * query.radius_m;
  const float inner = query.inner_radius_m * query.inner_radius_m;
  std::size_t found = 0;
  for (Eigen::Index begin = 0; begin < points.rows() && found < query.neighbours; begin += kBlock) {
    const Eigen::Index count = std::min(kBlock, points.rows() - begin);
    const Block squared = (points.col(0).segment(begin, count).array() - center.x()).square() +
                          (points.col(1).segment(begin, count).array() - center.y()).square() +
                          (points.col(2).segment(begin, count).array() - center.z()).square();
    if (squared.minCoeff() >= outer) continue;
    for (Eigen::Index i = 0; i < count && found < query.neighbours; ++i) {
      if (squared[i] < outer && squared[i] >= inner) slots[found++] = static_cast<std::uint32_t>(begin + i);
    }
  }
  return found;
}

}  // namespace

std::vector<std::uint32_t> farthest_point_sampling(const Eigen::Ref<const RowMatrix>& rows,
                                                   std::size_t count) {
  const std::size_t wanted = std::min(static_cast<std::size_t>(rows.rows()), count);
  std::vector<std::uint32_t> chosen;
  chosen.reserve(wanted);
  const Eigen::MatrixXf points = rows;
  Eigen::ArrayXf nearest = Eigen::ArrayXf::Constant(points.rows(), std::numeric_limits<float>::max());
  Eigen::Index next = 0;
  while (chosen.size() < wanted) {
    chosen.push_back(static_cast<std::uint32_t>(next));
    const Eigen::RowVectorXf last = points.row(next);
    Farthest farthest;
    for (Eigen::Index begin = 0; begin < points.rows(); begin += kBlock) {
      const Farthest of_block = lower_distances(points, last, begin, nearest);
      if (of_block.distance > farthest.distance) farthest = of_block;
    }
    if (farthest.distance <= 0.0F) break;  // all others lie on chosen ones
    next = farthest.index;
  }
  return chosen;
}

Groups query_balls(const PointRows& points, const PointRows& centers, const BallQuery& query) {
  const auto num_centers = static_cast<std::size_t>(centers.rows());
  const Eigen::Matrix<float, Eigen::Dynamic, 3> by_column = points;
  std::vector<std::uint32_t> slots(num_centers * query.neighbours);
  std::vector<std::uint32_t> counts(num_centers, 0);
  parallel_for_each_index(
      num_centers,
      [&](std::size_t i) {
        const Eigen::Vector3f center = centers.row(static_cast<Eigen::Index>(i)).transpose();
        counts[i] = static_cast<std::uint32_t>(
            find_neighbors(by_column, center, query, slots.data() + i * query.neighbours));
      },
      16);
  Groups groups;
  for (std::size_t i = 0; i < num_centers; ++i) {
    const auto slot = slots.begin() + static_cast<std::ptrdiff_t>(i * query.neighbours);
    groups.members.insert(groups.members.end(), slot, slot + counts[i]);
    groups.begins.push_back(static_cast<std::uint32_t>(groups.members.size()));
  }
  return groups;
}

}  // namespace mlo
