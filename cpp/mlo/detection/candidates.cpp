#include "mlo/detection/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "mlo/detection/box_fit.hpp"

namespace mlo {
namespace {

const std::array<ClassSize, 5> kClassSizes{ClassSize{ObjectClass::car, {4.1, 1.75, 1.5}, {5.4, 2.4}},
                                           ClassSize{ObjectClass::van, {5.1, 1.95, 2.2}, {6.3, 2.7}},
                                           ClassSize{ObjectClass::truck, {10.0, 2.5, 3.5}, {15.0, 3.4}},
                                           ClassSize{ObjectClass::pedestrian, {0.7, 0.6, 1.75}, {1.4, 1.2}},
                                           ClassSize{ObjectClass::cyclist, {1.75, 0.6, 1.75}, {2.5, 1.3}}};

// A rectangle is fitted to about so many points; more cost time without changing it.
constexpr std::size_t kFitPoints = 160;
// Lower than this over the typical height, nothing says what it is.
constexpr double kMinTop = 0.4;

/// What a cluster is made of.
struct Gathered {
  std::vector<ElevatedPoint> points;
  std::vector<Eigen::Vector2f> outline;  // some of them, seen from above
  double top_m = 0.0;                    // of all returns in its cells
  double bottom_m = 0.0;
  double range_m = 0.0;
  double mean_span_m = 0.0;  // of the heights within a cell
};

/// The longer side of the cells' bounding box.
double extent_of(const CellCluster& cluster, const CellGrid& grid) {
  const CellGrid::Cell& first = grid.cells()[cluster.front()];
  int min_column = first.column;
  int max_column = first.column;
  for (const std::uint32_t i : cluster) {
    min_column = std::min(min_column, grid.cells()[i].column);
    max_column = std::max(max_column, grid.cells()[i].column);
  }
  const int rows = grid.cells()[cluster.back()].row - first.row;  // cells are in the order of their rows
  return static_cast<double>(grid.cell_m()) *
         static_cast<double>(std::max(rows, max_column - min_column) + 1);
}

Gathered gather(const CellCluster& cluster, const CellGrid& grid) {
  Gathered gathered;
  gathered.bottom_m = 1e9;
  for (const std::uint32_t i : cluster) {
    const CellGrid::Cell& cell = grid.cells()[i];
    const std::span<const ElevatedPoint> points = grid.points_of(cell);
    const auto [low, high] = std::ranges::minmax(points, {}, &ElevatedPoint::height_m);
    gathered.points.insert(gathered.points.end(), points.begin(), points.end());
    gathered.top_m = std::max(gathered.top_m, static_cast<double>(cell.top_m));
    gathered.bottom_m = std::min(gathered.bottom_m, static_cast<double>(low.height_m));
    gathered.mean_span_m += static_cast<double>(high.height_m - low.height_m);
    gathered.range_m += static_cast<double>(cell.range_m);
  }
  const auto num_cells = static_cast<double>(cluster.size());
  gathered.mean_span_m /= num_cells;
  gathered.range_m /= num_cells;
  const std::size_t step = std::max<std::size_t>(1, gathered.points.size() / kFitPoints);
  for (std::size_t i = 0; i < gathered.points.size(); i += step) {
    gathered.outline.emplace_back(gathered.points[i].p_lidar.head<2>());
  }
  return gathered;
}

/// An interval along one axis of the box that holds what is seen and is as long as typical: the end that is
/// nearer to the lidar (at 0) stays.
Eigen::Vector2d completed(double min_m, double max_m, double typical_m) {
  const double missing_m = std::max(0.0, typical_m - (max_m - min_m));
  if (min_m > 0.0) return {min_m, max_m + missing_m};
  if (max_m < 0.0) return {min_m - missing_m, max_m};
  return {min_m - 0.5 * missing_m, max_m + 0.5 * missing_m};
}

/// @param along  index of the rectangle's axis that the length lies along
Box3d complete_box(const FittedRectangle& rectangle, Eigen::Index along, const ClassSize& size, double top_m,
                   const GroundHeights& ground) {
  const Eigen::Index across = 1 - along;
  const Eigen::Vector3d& typical = size.typical_lwh_m;
  std::array<Eigen::Vector2d, 2> spans;
  spans[static_cast<std::size_t>(along)] =
      completed(rectangle.min_m(along), rectangle.max_m(along), typical.x());
  spans[static_cast<std::size_t>(across)] =
      completed(rectangle.min_m(across), rectangle.max_m(across), typical.y());
  const Eigen::Vector2d middle(spans[0].mean(), spans[1].mean());
  const double c = std::cos(rectangle.yaw_rad);
  const double s = std::sin(rectangle.yaw_rad);
  Box3d box;
  box.center_lidar_m.head<2>() << c * middle.x() - s * middle.y(), s * middle.x() + c * middle.y();
  const auto length = spans[static_cast<std::size_t>(along)];
  const auto width = spans[static_cast<std::size_t>(across)];
  // parts higher than the class may be belong to something above
  const double height_m = std::clamp(top_m, 0.9 * typical.z(), 1.15 * typical.z());
  box.size_lwh_m = {length.y() - length.x(), width.y() - width.x(), height_m};
  const double ground_m = static_cast<double>(ground.at(box.center_lidar_m.head<2>().cast<float>()));
  box.center_lidar_m.z() = ground_m + 0.5 * height_m;
  box.yaw_rad = rectangle.yaw_rad + (along == 0 ? 0.0 : 0.5 * std::numbers::pi);
  return box;
}

double share(std::size_t part, std::size_t all) {
  return all == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(all);
}

/// Looks at places in and around a box.
class Surroundings {
 public:
  Surroundings(const Box3d& box, const CellCluster& cluster, const CellGrid& grid)
      : box_(box), cluster_(cluster), grid_(grid) {
    const auto cell_m = static_cast<double>(grid.cell_m());
    look_inside(2.0 * cell_m);
    look_around(0.5, 2.0 * cell_m);
  }

  double crowded() const { return share(occupied_around_, around_); }
  double others() const { return share(others_inside_, inside_); }
  double ground_inside() const { return share(ground_inside_, well_inside_); }

 private:
  Eigen::Vector2f place(double x_m, double y_m) const {
    const double c = std::cos(box_.yaw_rad);
    const double s = std::sin(box_.yaw_rad);
    return (box_.center_lidar_m.head<2>() + Eigen::Vector2d(c * x_m - s * y_m, s * x_m + c * y_m))
        .cast<float>();
  }
  bool is_other(int cell) const {
    return cell >= 0 && !std::ranges::binary_search(cluster_, static_cast<std::uint32_t>(cell));
  }
  void look_inside(double step_m) {
    constexpr double kRim_m = 0.3;  // the ground is seen below the rim of what stands on wheels
    const Eigen::Vector2d half = 0.5 * box_.size_lwh_m.head<2>();
    for (double x = -half.x() + 0.5 * step_m; x < half.x(); x += step_m) {
      for (double y = -half.y() + 0.5 * step_m; y < half.y(); y += step_m) {
        const Eigen::Vector2f p = place(x, y);
        ++inside_;
        if (is_other(grid_.find(p))) ++others_inside_;
        if (std::abs(x) > half.x() - kRim_m || std::abs(y) > half.y() - kRim_m) continue;
        ++well_inside_;
        if (grid_.shows_ground(p)) ++ground_inside_;
      }
    }
  }
  void look_around(double distance_m, double step_m) {
    const Eigen::Vector2d half = 0.5 * box_.size_lwh_m.head<2>() + Eigen::Vector2d::Constant(distance_m);
    const auto look = [&](double x, double y) {
      ++around_;
      if (is_other(grid_.find(place(x, y)))) ++occupied_around_;
    };
    for (const double sign : {-1.0, 1.0}) {
      for (double x = -half.x(); x <= half.x(); x += step_m) look(x, sign * half.y());
      for (double y = -half.y(); y <= half.y(); y += step_m) look(sign * half.x(), y);
    }
  }

  const Box3d& box_;
  const CellCluster& cluster_;
  const CellGrid& grid_;
  std::size_t inside_ = 0, others_inside_ = 0, well_inside_ = 0, ground_inside_ = 0, around_ = 0,
              occupied_around_ = 0;
};

CandidateFeatures describe(const Gathered& gathered, const Eigen::Vector2d& seen_lw_m,
                           const FittedRectangle& rectangle, const ClassSize& size,
                           const Surroundings& around, double overhang) {
  const Eigen::Vector3d& typical = size.typical_lwh_m;
  const auto is_upper = [&](const ElevatedPoint& p) {
    return static_cast<double>(p.height_m) > 0.6 * typical.z();
  };
  const auto is_lower = [&](const ElevatedPoint& p) {
    return static_cast<double>(p.height_m) < 0.3 * typical.z();
  };
  const auto count = gathered.points.size();
  return {seen_lw_m.x() / typical.x(),
          seen_lw_m.y() / typical.y(),
          std::min(gathered.top_m / typical.z(), 3.0),
          gathered.bottom_m,
          std::log10(static_cast<double>(count)),
          gathered.range_m / 50.0,
          std::min(rectangle.mean_distance_m / 0.2, 3.0),
          share(static_cast<std::size_t>(std::ranges::count_if(gathered.points, is_upper)), count),
          share(static_cast<std::size_t>(std::ranges::count_if(gathered.points, is_lower)), count),
          overhang,
          gathered.mean_span_m / typical.z(),
          around.crowded(),
          around.others(),
          around.ground_inside()};
}

/// Share of the cells with returns above a height.
double overhang_of(const CellCluster& cluster, const CellGrid& grid, double height_m) {
  const auto is_higher = [&](std::uint32_t i) {
    return static_cast<double>(grid.cells()[i].top_m) > height_m;
  };
  return share(static_cast<std::size_t>(std::ranges::count_if(cluster, is_higher)), cluster.size());
}

}  // namespace

std::span<const ClassSize> class_sizes() {
  return kClassSizes;
}

std::vector<Candidate> candidates_of(const CellCluster& cluster, const CellGrid& grid,
                                     const GroundHeights& ground, const ClusterConfig& config) {
  std::vector<Candidate> candidates;
  const double largest_m = std::ranges::max(kClassSizes, {}, [](const ClassSize& size) {
                             return size.max_lw_m.x();
                           }).max_lw_m.norm();
  if (cluster.empty() || extent_of(cluster, grid) > largest_m) return candidates;
  const Gathered gathered = gather(cluster, grid);
  if (gathered.points.size() < static_cast<std::size_t>(config.min_points)) return candidates;
  const FittedRectangle rectangle = fit_rectangle(gathered.outline);
  for (const ClassSize& size : kClassSizes) {
    if (gathered.top_m < kMinTop * size.typical_lwh_m.z()) continue;
    for (const Eigen::Index along : {0, 1}) {
      const Eigen::Vector2d seen_lw_m(rectangle.extent_m()(along), rectangle.extent_m()(1 - along));
      if ((seen_lw_m.array() > size.max_lw_m.array()).any()) continue;
      Candidate candidate;
      candidate.object_class = size.object_class;
      candidate.box = complete_box(rectangle, along, size, gathered.top_m, ground);
      const Surroundings around(candidate.box, cluster, grid);
      candidate.features = describe(gathered, seen_lw_m, rectangle, size, around,
                                    overhang_of(cluster, grid, 1.15 * size.typical_lwh_m.z()));
      candidates.push_back(candidate);
    }
  }
  return candidates;
}

}  // namespace mlo
