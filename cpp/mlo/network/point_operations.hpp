#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace mlo {

/// One row per point.
using RowMatrix = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using PointRows = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// Farthest point sampling: begins with the first point and adds, again and again, the one that is farthest
/// from all chosen so far (the first of equals), until there are enough or none is left.
/// @param rows  one point per row; distances are Euclidean over all columns
/// @return indices in the order of choice
std::vector<std::uint32_t> farthest_point_sampling(const Eigen::Ref<const RowMatrix>& rows,
                                                   std::size_t count);

/// Neighbours of centres: those of centre i are members[begins[i]] to members[begins[i + 1] - 1].
struct Groups {
  std::vector<std::uint32_t> begins = {0};
  std::vector<std::uint32_t> members;

  std::size_t size() const { return begins.size() - 1; }
};

/// A shell around each centre.
struct BallQuery {
  float inner_radius_m = 0.0F;
  float radius_m = 0.0F;
  std::size_t neighbours = 0;
};

/// The first so many points, in their order, with inner_radius <= distance < radius of each centre; fewer
/// where there are not so many.
Groups query_balls(const PointRows& points, const PointRows& centers, const BallQuery& query);

}  // namespace mlo
