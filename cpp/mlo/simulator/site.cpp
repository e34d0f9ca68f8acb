#include "mlo/simulator/site.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

namespace mlo::simulator {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

struct Axes {
  Vector2d ahead, left;
};

Axes axes(const Footprint& f) {
  const Vector2d ahead(std::cos(f.yaw_rad), std::sin(f.yaw_rad));
  return {ahead, {-ahead.y(), ahead.x()}};
}

double half_extent_along(const Footprint& f, const Vector2d& direction, double margin_m) {
  const auto [ahead, left] = axes(f);
  return 0.5 * (f.length_m + margin_m) * std::abs(ahead.dot(direction)) +
         0.5 * (f.width_m + margin_m) * std::abs(left.dot(direction));
}

/// Uneven ground: the same bump for the same grid corner.
double bump(int x, int y, std::uint64_t seed) {
  const std::uint64_t corner = mix(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y));
  return Random(mix(seed, corner)).uniform(-1.0, 1.0);
}

}  // namespace

bool overlap(const Footprint& a, const Footprint& b, double margin_m) {
  const Vector2d between = b.center - a.center;
  const double reach =
      0.5 * (std::hypot(a.length_m, a.width_m) + std::hypot(b.length_m, b.width_m)) + margin_m;
  if (between.squaredNorm() > reach * reach) return false;
  const auto [a_ahead, a_left] = axes(a);
  const auto [b_ahead, b_left] = axes(b);
  return std::ranges::all_of(std::array{a_ahead, a_left, b_ahead, b_left}, [&](const Vector2d& axis) {
    return std::abs(between.dot(axis)) <=
           half_extent_along(a, axis, margin_m) + half_extent_along(b, axis, margin_m);
  });
}

std::int64_t Site::cell_key(int x, int y) {
  return (static_cast<std::int64_t>(x) << 32) ^ static_cast<std::uint32_t>(y);
}

template <class Visit>
void Site::visit_samples_near(const Vector2d& p_world, const Visit& visit) const {
  const int cx = static_cast<int>(std::floor(p_world.x() / kCell_m));
  const int cy = static_cast<int>(std::floor(p_world.y() / kCell_m));
  for (int x = cx - 1; x <= cx + 1; ++x) {
    for (int y = cy - 1; y <= cy + 1; ++y) {
      const auto cell = samples_.find(cell_key(x, y));
      if (cell == samples_.end()) continue;
      for (const Sample& sample : cell->second) visit(sample);
    }
  }
}

std::size_t Site::add_road(const Path& centerline, double half_width_m, double sidewalk_m) {
  for (double s = 0.0; s <= centerline.length_m() + 0.5 * kSampleStep_m; s += kSampleStep_m) {
    const Vector2d p = centerline.at(s).p_world;
    const std::int64_t key = cell_key(static_cast<int>(std::floor(p.x() / kCell_m)),
                                      static_cast<int>(std::floor(p.y() / kCell_m)));
    samples_[key].push_back({p, half_width_m, sidewalk_m, roads_.size()});
  }
  roads_.push_back({centerline, half_width_m, sidewalk_m});
  return roads_.size() - 1;
}

Surface Site::surface_at(const Vector2d& p_world) const {
  Surface surface = Surface::grass;
  visit_samples_near(p_world, [&](const Sample& sample) {
    const double beyond = (sample.p_world - p_world).norm() - sample.half_width_m;
    if (beyond <= 0.0) {
      surface = Surface::road;
    } else if (beyond <= sample.sidewalk_m && surface != Surface::road) {
      surface = Surface::sidewalk;
    }
  });
  return surface;
}

bool Site::is_free(const Footprint& footprint) const {
  if (std::ranges::any_of(taken_, [&](const Footprint& other) { return overlap(footprint, other, 0.1); })) {
    return false;
  }
  constexpr double kProbe_m = 1.5;
  const auto [ahead, left] = axes(footprint);
  const int rows = static_cast<int>(std::ceil(footprint.length_m / kProbe_m)) + 1;
  const int columns = static_cast<int>(std::ceil(footprint.width_m / kProbe_m)) + 1;
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < columns; ++j) {
      const Vector2d p = footprint.center +
                         (static_cast<double>(i) / (rows - 1) - 0.5) * footprint.length_m * ahead +
                         (static_cast<double>(j) / (columns - 1) - 0.5) * footprint.width_m * left;
      if (surface_at(p) != Surface::grass) return false;
    }
  }
  return true;
}

bool Site::near_another_road(const Vector2d& p_world, std::size_t road, double margin_m) const {
  bool found = false;
  visit_samples_near(p_world, [&](const Sample& sample) {
    found =
        found || (sample.road != road && (sample.p_world - p_world).norm() < sample.half_width_m + margin_m);
  });
  return found;
}

Mesh Site::ground(const Terrain& terrain, const Path& way, double reach_m, double cell_m, double roughness_m,
                  std::uint64_t seed) const {
  std::map<std::pair<int, int>, bool> cells;  // ordered: the mesh must not depend on a hash
  const int reach = static_cast<int>(std::ceil(reach_m / cell_m));
  for (double s = 0.0; s <= way.length_m() + 10.0; s += 10.0) {
    const Vector2d p = way.at(s).p_world;
    const int cx = static_cast<int>(std::floor(p.x() / cell_m));
    const int cy = static_cast<int>(std::floor(p.y() / cell_m));
    for (int x = cx - reach; x <= cx + reach; ++x) {
      const int half =
          static_cast<int>(std::sqrt(std::max(0.0, 1.0 * reach * reach - 1.0 * (x - cx) * (x - cx))));
      for (int y = cy - half; y <= cy + half; ++y) cells[{x, y}] = true;
    }
  }
  Mesh mesh;
  std::map<std::pair<int, int>, std::uint32_t> corners;
  const auto corner = [&](int x, int y) {
    const auto [entry, is_new] =
        corners.try_emplace({x, y}, static_cast<std::uint32_t>(mesh.vertices.size()));
    if (is_new) {
      const Vector2d p(x * cell_m, y * cell_m);
      const bool rough = surface_at(p) == Surface::grass;
      const double z = terrain.height(p) + (rough ? roughness_m * bump(x, y, seed) : 0.0);
      mesh.vertices.push_back(Vector3d(p.x(), p.y(), z).cast<float>());
    }
    return entry->second;
  };
  for (const auto& [cell, unused] : cells) {
    const auto [x, y] = cell;
    const Surface surface = surface_at({(x + 0.5) * cell_m, (y + 0.5) * cell_m});
    const std::array<std::uint32_t, 4> c{corner(x, y), corner(x + 1, y), corner(x + 1, y + 1),
                                         corner(x, y + 1)};
    mesh.triangles.push_back({{c[0], c[1], c[2]}, surface});
    mesh.triangles.push_back({{c[0], c[2], c[3]}, surface});
  }
  return mesh;
}

Mesh Site::sidewalks(const Terrain& terrain) const {
  constexpr double kStep_m = 1.0;
  Mesh mesh;
  for (std::size_t i = 0; i < roads_.size(); ++i) {
    const Road& road = roads_[i];
    if (road.sidewalk_m <= 0.0) continue;
    for (const double side : {-1.0, 1.0}) {
      const double kerb = side * road.half_width_m;
      const double back = kerb + side * road.sidewalk_m;
      const std::vector<Vector2d> profile{{kerb, -0.05}, {kerb, kKerb_m}, {back, kKerb_m}, {back, -0.3}};
      double from = 0.0;
      for (double s = 0.0; s <= road.centerline.length_m(); s += kStep_m) {
        const PathPoint point = road.centerline.at(s);
        const bool gap = near_another_road(point.p_world + (kerb + 0.5 * side) * point.left(), i, 0.3) ||
                         near_another_road(point.p_world + back * point.left(), i, 0.3);
        const bool end = s + kStep_m > road.centerline.length_m();
        if ((gap || end) && s - from > 1.5) {
          mesh += extrude(terrain, road.centerline.part(from, s), profile,
                          {Surface::sidewalk, Surface::sidewalk, Surface::sidewalk}, 2.0);
        }
        if (gap) from = s + kStep_m;
      }
    }
  }
  return mesh;
}

Mesh extrude(const Terrain& terrain, const Path& path, const std::vector<Vector2d>& profile,
             const std::vector<Surface>& surfaces, double step_m) {
  const int steps = std::max(1, static_cast<int>(std::ceil(path.length_m() / step_m)));
  std::vector<Ring> rings;
  for (int i = 0; i <= steps; ++i) {
    const PathPoint point = path.at(path.length_m() * i / steps);
    Ring ring;
    for (const Vector2d& corner : profile) {
      const Vector2d p = point.p_world + corner.x() * point.left();
      ring.emplace_back(p.x(), p.y(), terrain.height(p) + corner.y());
    }
    rings.push_back(ring);
  }
  return loft(rings, false, [&](std::size_t, std::size_t j) { return surfaces[j]; });
}

}  // namespace mlo::simulator
