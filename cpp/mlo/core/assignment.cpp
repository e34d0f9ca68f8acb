#include "mlo/core/assignment.hpp"

#include <algorithm>
#include <limits>

namespace mlo {
namespace {

constexpr Eigen::Index kFree = -1;

// State of the search over a matrix that has no more rows than columns.
class Solver {
 public:
  explicit Solver(const Eigen::MatrixXd& cost)
      : cost_(cost),
        row_price_(Eigen::VectorXd::Zero(cost.rows())),
        col_price_(Eigen::VectorXd::Zero(cost.cols())),
        col_of_row_(static_cast<std::size_t>(cost.rows()), kFree),
        row_of_col_(static_cast<std::size_t>(cost.cols()), kFree) {}

  const std::vector<Eigen::Index>& solve() {
    for (Eigen::Index row = 0; row < cost_.rows(); ++row) add_row(row);
    return col_of_row_;
  }

 private:
  // Extends the assignment of earlier rows by the cheapest path from this row to a free column.
  void add_row(Eigen::Index start) {
    const auto cols = static_cast<std::size_t>(cost_.cols());
    std::vector<double> path_cost(cols, std::numeric_limits<double>::infinity());
    std::vector<Eigen::Index> previous_row(cols, kFree);
    std::vector<bool> done(cols, false);
    std::vector<Eigen::Index> rows_on_paths{start};
    double length = 0.0;
    Eigen::Index row = start;
    Eigen::Index sink = kFree;
    while (sink == kFree) {
      const Eigen::Index nearest = relax(row, length, path_cost, previous_row, done);
      length = path_cost[static_cast<std::size_t>(nearest)];
      done[static_cast<std::size_t>(nearest)] = true;
      row = row_of_col_[static_cast<std::size_t>(nearest)];
      if (row == kFree) {
        sink = nearest;
      } else {
        rows_on_paths.push_back(row);
      }
    }
    update_prices(start, length, path_cost, done, rows_on_paths);
    augment(start, sink, previous_row);
  }

  // Shortens paths through the row; gives the nearest column that is not done (a free one where equal).
  Eigen::Index relax(Eigen::Index row, double length, std::vector<double>& path_cost,
                     std::vector<Eigen::Index>& previous_row, const std::vector<bool>& done) const {
    Eigen::Index nearest = kFree;
    double lowest = std::numeric_limits<double>::infinity();
    for (Eigen::Index col = 0; col < cost_.cols(); ++col) {
      const auto j = static_cast<std::size_t>(col);
      if (done[j]) continue;
      const double through = length + cost_(row, col) - row_price_(row) - col_price_(col);
      if (through < path_cost[j]) {
        path_cost[j] = through;
        previous_row[j] = row;
      }
      if (path_cost[j] < lowest || (path_cost[j] == lowest && row_of_col_[j] == kFree)) {
        lowest = path_cost[j];
        nearest = col;
      }
    }
    return nearest;
  }

  void update_prices(Eigen::Index start, double length, const std::vector<double>& path_cost,
                     const std::vector<bool>& done, const std::vector<Eigen::Index>& rows_on_paths) {
    row_price_(start) += length;
    for (const Eigen::Index row : rows_on_paths) {
      if (row == start) continue;
      const Eigen::Index col = col_of_row_[static_cast<std::size_t>(row)];
      row_price_(row) += length - path_cost[static_cast<std::size_t>(col)];
    }
    for (Eigen::Index col = 0; col < cost_.cols(); ++col) {
      const auto j = static_cast<std::size_t>(col);
      if (done[j]) col_price_(col) -= length - path_cost[j];
    }
  }

  void augment(Eigen::Index start, Eigen::Index sink, const std::vector<Eigen::Index>& previous_row) {
    Eigen::Index col = sink;
    Eigen::Index row = kFree;
    while (row != start) {
      row = previous_row[static_cast<std::size_t>(col)];
      row_of_col_[static_cast<std::size_t>(col)] = row;
      std::swap(col_of_row_[static_cast<std::size_t>(row)], col);
    }
  }

  const Eigen::MatrixXd& cost_;
  Eigen::VectorXd row_price_;
  Eigen::VectorXd col_price_;
  std::vector<Eigen::Index> col_of_row_;
  std::vector<Eigen::Index> row_of_col_;
};

}  // namespace

std::vector<Assignment> optimal_assignment(const Eigen::MatrixXd& cost) {
  std::vector<Assignment> pairs;
  if (cost.size() == 0) return pairs;
  const bool tall = cost.rows() > cost.cols();
  const Eigen::MatrixXd wide = tall ? Eigen::MatrixXd(cost.transpose()) : cost;
  Solver solver(wide);
  const std::vector<Eigen::Index>& partners = solver.solve();
  for (std::size_t i = 0; i < partners.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    pairs.push_back(tall ? Assignment{partners[i], index} : Assignment{index, partners[i]});
  }
  std::sort(pairs.begin(), pairs.end(),
            [](const Assignment& a, const Assignment& b) { return a.row < b.row; });
  return pairs;
}

}  // namespace mlo
