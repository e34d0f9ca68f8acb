#include "mlo/network/point_operations.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "mlo/core/parallel.hpp"

namespace mlo {
namespace {

// Points of a farthest point sampling in blocks of neighbours, so that a chosen point only looks at those
// whose distances it can lower.
class SampledBlocks {
 public:
  explicit SampledBlocks(const Eigen::Ref<const RowMatrix>& rows)
      : indices_(static_cast<std::size_t>(rows.rows())) {
    std::iota(indices_.begin(), indices_.end(), 0U);
    split(rows, 0, rows.rows());
    points_.resize(rows.rows(), rows.cols());
    for (Eigen::Index i = 0; i < rows.rows(); ++i) points_.row(i) = rows.row(index(i));
    nearest_ = Eigen::ArrayXf::Constant(rows.rows(), std::numeric_limits<float>::max());
    for (Eigen::Index begin = 0; begin < rows.rows(); begin += kBlock) {
      const auto positions = points_.middleRows(begin, size(begin)).leftCols<3>();
      blocks_.push_back({positions.colwise().minCoeff(), positions.colwise().maxCoeff()});
    }
  }

  /// Lowers the distances to those from a point.
  void choose(const Eigen::RowVectorXf& chosen) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (blocks_[b].squared_distance(chosen) < blocks_[b].farthest) lower(b, chosen);
    }
  }

  float farthest() const { return std::ranges::max(blocks_, {}, &Block::farthest).farthest; }

  /// The first of the points at this distance.
  Eigen::Index first_at(float distance) const {
    Eigen::Index first = points_.rows();
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      if (blocks_[b].farthest != distance) continue;
      const Eigen::Index begin = static_cast<Eigen::Index>(b) * kBlock;
      for (Eigen::Index i = begin; i < begin + size(begin); ++i) {
        if (nearest_[i] == distance) first = std::min(first, index(i));
      }
    }
    return first;
  }

 private:
  static constexpr Eigen::Index kBlock = 64;

  struct Block {
    Eigen::RowVector3f low, high;  // of positions
    float farthest = std::numeric_limits<float>::max();

    float squared_distance(const Eigen::RowVectorXf& point) const {
      const Eigen::Array<float, 1, 3> p = point.head<3>().array();
      return (low.array() - p).max(p - high.array()).max(0.0F).matrix().squaredNorm();
    }
  };

  Eigen::Index index(Eigen::Index i) const { return indices_[static_cast<std::size_t>(i)]; }
  Eigen::Index size(Eigen::Index begin) const { return std::min(kBlock, points_.rows() - begin); }

  // Halves along the longest side, in whole blocks.
  void split(const Eigen::Ref<const RowMatrix>& rows, Eigen::Index begin, Eigen::Index end) {
    const Eigen::Index num_blocks = (end - begin + kBlock - 1) / kBlock;
    if (num_blocks <= 1) return;
    Eigen::RowVector3f low = rows.row(index(begin)).head<3>();
    Eigen::RowVector3f high = low;
    for (Eigen::Index i = begin; i < end; ++i) {
      low = low.cwiseMin(rows.row(index(i)).head<3>());
      high = high.cwiseMax(rows.row(index(i)).head<3>());
    }
    Eigen::Index axis = 0;
    (high - low).maxCoeff(&axis);
    const Eigen::Index middle = begin + num_blocks / 2 * kBlock;
    const auto coordinate = [&](std::uint32_t i) { return rows(i, axis); };
    std::ranges::nth_element(indices_.begin() + begin, indices_.begin() + middle, indices_.begin() + end, {},
                             coordinate);
    split(rows, begin, middle);
    split(rows, middle, end);
  }

  void lower(std::size_t b, const Eigen::RowVectorXf& chosen) {
    const Eigen::Index begin = static_cast<Eigen::Index>(b) * kBlock;
    const Eigen::Index count = size(begin);
    Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1> squared =
        (points_.col(0).segment(begin, count).array() - chosen[0]).square();
    for (Eigen::Index column = 1; column < points_.cols(); ++column) {
      squared += (points_.col(column).segment(begin, count).array() - chosen[column]).square();
    }
    auto distances = nearest_.segment(begin, count);
    distances = distances.min(squared);
    blocks_[b].farthest = distances.maxCoeff();
  }

  std::vector<std::uint32_t> indices_;  // of the rows, in the order of the blocks
  Eigen::MatrixXf points_;
  Eigen::ArrayXf nearest_;  // squared distance to the nearest chosen point
  std::vector<Block> blocks_;
};

// Points sorted by the columns of space that they are in, which are at least as wide as the radius of search:
// all neighbours of a centre are in the nine columns around it. In a column, points are in their order.
class Columns {
 public:
  Columns(const PointRows& points, float radius_m) {
    if (points.rows() == 0) return;
    low_ = points.leftCols<2>().colwise().minCoeff().transpose();
    const Eigen::Array2f extent = points.leftCols<2>().colwise().maxCoeff().transpose().array() - low_;
    const float side = std::max({radius_m, extent.maxCoeff() / kMaxAcross, kLeastSide});
    inverse_side_ = 1.0F / side;
    across_ = (extent * inverse_side_).cast<int>() + 1;
    sort(points);
  }

  /// Up to so many neighbours of a centre, the first in the order of the points.
  std::size_t find(const Eigen::Vector3f& center, const BallQuery& query, std::uint32_t* slots) const {
    if (!center.allFinite()) return 0;
    std::vector<std::uint32_t> within;
    // Compared as numbers of any size: centres may lie far outside.
    const Eigen::Array2f place = ((center.head<2>().array() - low_) * inverse_side_).floor();
    const Eigen::Array2i first = (place - 1.0F).max(0.0F).min(kMaxAcross + 1.0F).cast<int>();
    const Eigen::Array2i last = (place + 1.0F).min((across_ - 1).cast<float>()).max(-1.0F).cast<int>();
    for (int y = first.y(); y <= last.y() && first.x() <= last.x(); ++y) {
      const std::size_t row = static_cast<std::size_t>(y) * static_cast<std::size_t>(across_.x());
      append_within(begins_[row + static_cast<std::size_t>(first.x())],
                    begins_[row + static_cast<std::size_t>(last.x()) + 1], center, query, within);
    }
    const std::size_t count = std::min(query.neighbours, within.size());
    std::partial_sort_copy(within.begin(), within.end(), slots, slots + count);
    return count;
  }

 private:
  static constexpr float kMaxAcross = 256.0F;
  static constexpr float kLeastSide = 1e-3F;

  void sort(const PointRows& points) {
    const auto count = static_cast<std::size_t>(points.rows());
    std::vector<std::size_t> cells(count);
    begins_.assign(static_cast<std::size_t>(across_.prod()) + 1, 0);
    for (std::size_t i = 0; i < count; ++i) {
      const auto row = points.row(static_cast<Eigen::Index>(i));
      const Eigen::Array2i cell = ((row.head<2>().transpose().array() - low_) * inverse_side_).cast<int>();
      cells[i] = static_cast<std::size_t>(cell.y()) * static_cast<std::size_t>(across_.x()) +
                 static_cast<std::size_t>(cell.x());
      ++begins_[cells[i] + 1];
    }
    std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
    std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
    sorted_.resize(points.rows(), 3);
    indices_.resize(count);
    for (std::size_t i = 0; i < count; ++i) {
      const std::uint32_t place = next[cells[i]]++;
      indices_[place] = static_cast<std::uint32_t>(i);
      sorted_.row(place) = points.row(static_cast<Eigen::Index>(i));
    }
  }

  void append_within(std::uint32_t begin, std::uint32_t end, const Eigen::Vector3f& center,
                     const BallQuery& query, std::vector<std::uint32_t>& within) const {
    const float outer = query.radius_m * query.radius_m;
    const float inner = query.inner_radius_m * query.inner_radius_m;
    for (std::uint32_t i = begin; i < end; ++i) {
      const float squared = (sorted_.row(i).transpose() - center).squaredNorm();
      if (squared < outer && squared >= inner) within.push_back(indices_[i]);
    }
  }

  Eigen::Array2f low_{0.0F, 0.0F};
  Eigen::Array2i across_{0, 0};
  float inverse_side_ = 0.0F;
  std::vector<std::uint32_t> begins_;  // of each column and the end, row by row
  std::vector<std::uint32_t> indices_;
  PointRows sorted_;
};

}  // namespace

std::vector<std::uint32_t> farthest_point_sampling(const Eigen::Ref<const RowMatrix>& rows,
                                                   std::size_t count) {
  const std::size_t wanted = std::min(static_cast<std::size_t>(rows.rows()), count);
  std::vector<std::uint32_t> chosen;
  chosen.reserve(wanted);
  if (wanted == 0) return chosen;
  SampledBlocks blocks(rows);
  Eigen::Index next = 0;
  while (true) {
    chosen.push_back(static_cast<std::uint32_t>(next));
    if (chosen.size() == wanted) break;
    blocks.choose(rows.row(next));
    const float farthest = blocks.farthest();
    if (!(farthest > 0.0F)) break;  // all others lie on chosen ones
    next = blocks.first_at(farthest);
  }
  return chosen;
}

Groups query_balls(const PointRows& points, const PointRows& centers, const BallQuery& query) {
  const auto num_centers = static_cast<std::size_t>(centers.rows());
  const Columns columns(points, query.radius_m);
  std::vector<std::uint32_t> slots(num_centers * query.neighbours);
  std::vector<std::uint32_t> counts(num_centers, 0);
  parallel_for_each_index(
      num_centers,
      [&](std::size_t i) {
        const Eigen::Vector3f center = centers.row(static_cast<Eigen::Index>(i)).transpose();
        counts[i] =
            static_cast<std::uint32_t>(columns.find(center, query, slots.data() + i * query.neighbours));
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
