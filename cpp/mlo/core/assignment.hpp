#pragma once

#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace mlo {

/// A row of a cost matrix and the column it was given.
struct Assignment {
  Eigen::Index row = 0;
  Eigen::Index col = 0;
};

/// Optimal assignment (Kuhn-Munkres): min(rows, cols) pairs, each row and column at most once, of least total
/// cost. Shortest augmenting paths (Crouse, IEEE Trans. AES 2016), cubic in the smaller side. Pairs come in
/// row order.
/// @param cost  finite; for a pair that must not be, a cost larger than the sum of the others
std::vector<Assignment> optimal_assignment(const Eigen::MatrixXd& cost);

}  // namespace mlo
