#include "mlo/simulator/structures.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mlo::simulator {
namespace {

using Eigen::Vector3d;

constexpr double kFoundation_m = 2.0;  // reaches below the ground, so that slopes leave no gap
constexpr double kReveal_m = 0.18;     // how deep windows sit in the wall

/// One facade seen from outside: origin at its lower left corner, `along` to the right, `inward` into the
/// house.
struct Facade {
  Vector3d origin, along, inward;
  double width_m, storey_m;
  int storeys;
};

Vector3d on(const Facade& f, double x, double z, double depth = 0.0) {
  return f.origin + x * f.along + depth * f.inward + Vector3d(0, 0, z);
}

Mesh window(const Facade& f, double x0, double x1, double z0, double z1) {
  const double d = kReveal_m;
  Mesh mesh = quad(on(f, x0, z0, d), on(f, x1, z0, d), on(f, x1, z1, d), on(f, x0, z1, d), Surface::window);
  mesh += quad(on(f, x0, z0), on(f, x0, z0, d), on(f, x0, z1, d), on(f, x0, z1), Surface::wall);
  mesh += quad(on(f, x1, z0), on(f, x1, z0, d), on(f, x1, z1, d), on(f, x1, z1), Surface::wall);
  mesh += quad(on(f, x0, z0), on(f, x1, z0), on(f, x1, z0, d), on(f, x0, z0, d), Surface::wall);
  mesh += quad(on(f, x0, z1), on(f, x1, z1), on(f, x1, z1, d), on(f, x0, z1, d), Surface::wall);
  return mesh;
}

Mesh facade(const Facade& f, const BuildingShape& shape) {
  const double bay = shape.window_width_m + shape.window_gap_m;
  const int windows = std::max(0, static_cast<int>((f.width_m - shape.window_gap_m) / bay));
  const double margin = 0.5 * (f.width_m - windows * bay);
  const double top = f.storeys * f.storey_m;
  const auto wall = [&](double x0, double x1, double z0, double z1) {
    return quad(on(f, x0, z0), on(f, x1, z0), on(f, x1, z1), on(f, x0, z1), Surface::wall);
  };
  Mesh mesh = wall(0, f.width_m, -kFoundation_m, 0);
  mesh += wall(0, margin, 0, top);
  mesh += wall(f.width_m - margin, f.width_m, 0, top);
  for (int i = 0; i < windows; ++i) {
    const double x0 = margin + i * bay;
    const double x1 = x0 + 0.5 * shape.window_gap_m;
    const double x2 = x1 + shape.window_width_m;
    mesh += wall(x0, x1, 0, top);
    mesh += wall(x2, x0 + bay, 0, top);
    for (int storey = 0; storey < f.storeys; ++storey) {
      const double z = storey * f.storey_m;
      const double sill = z + (storey == 0 ? 0.7 : 0.9);
      const double lintel = z + 0.8 * f.storey_m;
      mesh += wall(x1, x2, z, sill);
      mesh += window(f, x1, x2, sill, lintel);
      mesh += wall(x1, x2, lintel, z + f.storey_m);
      if (shape.balconies && storey > 0 && i % 3 == 1) {
        mesh +=
            transformed(SE3(), quad(on(f, x0, z, -1.1), on(f, x0 + bay, z, -1.1),
                                    on(f, x0 + bay, z + 1.0, -1.1), on(f, x0, z + 1.0, -1.1), Surface::wall));
        mesh += quad(on(f, x0, z), on(f, x0 + bay, z), on(f, x0 + bay, z, -1.1), on(f, x0, z, -1.1),
                     Surface::wall);
      }
    }
  }
  return mesh;
}

Mesh roof(const BuildingShape& shape, double top) {
  const double x = 0.5 * shape.width_m;
  const double y = 0.5 * shape.depth_m;
  if (shape.roof_rise_m <= 0.0) {
    return quad({-x, -y, top}, {x, -y, top}, {x, y, top}, {-x, y, top}, Surface::roof);
  }
  constexpr double kEaves_m = 0.4;
  const double drop = kEaves_m * shape.roof_rise_m / y;
  const double ridge = top + shape.roof_rise_m;
  Mesh mesh;
  for (const double side : {-1.0, 1.0}) {
    mesh += quad({-x - kEaves_m, side * (y + kEaves_m), top - drop},
                 {x + kEaves_m, side * (y + kEaves_m), top - drop}, {x + kEaves_m, 0, ridge},
                 {-x - kEaves_m, 0, ridge}, Surface::roof);
    mesh += quad({side * x, -y, top}, {side * x, y, top}, {side * x, 0, ridge}, {side * x, 0, ridge},
                 Surface::wall);
  }
  return mesh;
}

Mesh plate(const Vector3d& center, double half_width, double half_height, Surface surface) {
  return cuboid(center - Vector3d(0.015, half_width, half_height),
                center + Vector3d(0.015, half_width, half_height), surface);
}

}  // namespace

Mesh make_building(const BuildingShape& shape) {
  const double x = 0.5 * shape.width_m;
  const double y = 0.5 * shape.depth_m;
  const auto side = [&](const Vector3d& origin, const Vector3d& along, double width) {
    const Vector3d inward = Vector3d::UnitZ().cross(along);
    return facade({origin, along, inward, width, shape.storey_m, shape.storeys}, shape);
  };
  Mesh mesh = side({-x, -y, 0}, Vector3d::UnitX(), shape.width_m);
  mesh += side({x, -y, 0}, Vector3d::UnitY(), shape.depth_m);
  mesh += side({x, y, 0}, -Vector3d::UnitX(), shape.width_m);
  mesh += side({-x, y, 0}, -Vector3d::UnitY(), shape.depth_m);
  mesh += roof(shape, shape.storeys * shape.storey_m);
  return mesh;
}

Mesh make_tree(double height_m, double crown_radius_m, Random random) {
  const double clear = std::max(1.6, 0.3 * height_m);
  Mesh mesh = tube({0, 0, -0.5}, {0, 0, clear + 0.3 * (height_m - clear)}, 0.02 * height_m, 0.014 * height_m,
                   Surface::bark, 10);
  const double half = 0.5 * (height_m - clear);
  mesh += foliage({0, 0, clear + half}, {crown_radius_m, crown_radius_m, half}, 700, 0.32, random.fork(0));
  for (std::uint64_t lobe = 1; lobe <= 3; ++lobe) {
    const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
    const Vector3d center(0.5 * crown_radius_m * std::cos(angle), 0.5 * crown_radius_m * std::sin(angle),
                          clear + half * random.uniform(0.6, 1.4));
    mesh += foliage(center, Vector3d::Constant(0.6 * crown_radius_m), 250, 0.3, random.fork(lobe));
    mesh += tube({0, 0, clear}, center, 0.06, 0.03, Surface::bark, 6);
  }
  return mesh;
}

Mesh make_bush(double radius_m, double height_m, Random random) {
  return foliage({0, 0, 0.45 * height_m}, {radius_m, radius_m, 0.55 * height_m}, 350, 0.14, random);
}

Mesh make_hedge(double length_m, double thickness_m, double height_m, Random random) {
  // a dark core that stops most light, and leaves around it
  const Vector3d half(0.5 * length_m, 0.5 * thickness_m, height_m);
  Mesh mesh =
      cuboid({-half.x(), -0.55 * half.y(), -0.3}, {half.x(), 0.55 * half.y(), 0.9 * half.z()}, Surface::leaf);
  const int leaves = static_cast<int>(120.0 * length_m * height_m);
  for (int i = 0; i < leaves; ++i) {
    const Vector3d place(random.uniform(-half.x(), half.x()), random.uniform(-half.y(), half.y()),
                         random.uniform(0.0, half.z()));
    mesh += foliage(place, {0.05, 0.05, 0.05}, 1, 0.11, random.fork(static_cast<std::uint64_t>(i)));
  }
  return mesh;
}

Mesh make_lamp(double height_m) {
  Mesh mesh = tube({0, 0, -0.3}, {0, 0, height_m}, 0.09, 0.05, Surface::pole);
  mesh += tube({0, 0, height_m}, {0, 1.6, height_m + 0.2}, 0.04, 0.04, Surface::pole, 6);
  mesh += cuboid({-0.12, 1.4, height_m + 0.12}, {0.12, 2.0, height_m + 0.28}, Surface::pole);
  return mesh;
}

Mesh make_sign() {
  Mesh mesh = tube({0, 0, -0.3}, {0, 0, 2.9}, 0.035, 0.035, Surface::pole);
  mesh += plate({-0.05, 0, 2.55}, 0.32, 0.32, Surface::sign);
  return mesh;
}

Mesh make_traffic_light() {
  Mesh mesh = tube({0, 0, -0.3}, {0, 0, 3.4}, 0.06, 0.06, Surface::pole);
  mesh += cuboid({-0.3, -0.16, 2.3}, {-0.05, 0.16, 3.2}, Surface::pole);
  return mesh;
}

Mesh make_gantry(double span_m) {
  constexpr double kHeight_m = 6.2;
  Mesh mesh;
  for (const double side : {-0.5, 0.5}) {
    mesh += tube({0, side * span_m, -0.5}, {0, side * span_m, kHeight_m}, 0.22, 0.2, Surface::pole, 10);
  }
  mesh += cuboid({-0.3, -0.5 * span_m, kHeight_m - 0.3}, {0.3, 0.5 * span_m, kHeight_m + 0.3}, Surface::pole);
  mesh +=
      cuboid({-0.45, -0.3 * span_m, kHeight_m - 1.0}, {-0.35, 0.3 * span_m, kHeight_m + 2.0}, Surface::sign);
  return mesh;
}

Mesh make_bin() {
  return cuboid({-0.3, -0.35, 0.0}, {0.3, 0.35, 1.1}, Surface::barrier);
}

Mesh make_fence(double length_m, double height_m) {
  Mesh mesh;
  const int posts = std::max(2, static_cast<int>(length_m / 2.0) + 1);
  for (int i = 0; i < posts; ++i) {
    const double x = length_m * (static_cast<double>(i) / (posts - 1) - 0.5);
    mesh += cuboid({x - 0.04, -0.04, -0.3}, {x + 0.04, 0.04, height_m}, Surface::barrier);
  }
  constexpr double kBoard_m = 0.12;
  constexpr double kSlit_m = 0.06;
  for (double x = -0.5 * length_m; x + kBoard_m <= 0.5 * length_m; x += kBoard_m + kSlit_m) {
    mesh += quad({x, 0.04, 0.08}, {x + kBoard_m, 0.04, 0.08}, {x + kBoard_m, 0.04, height_m - 0.05},
                 {x, 0.04, height_m - 0.05}, Surface::barrier);
  }
  return mesh;
}

}  // namespace mlo::simulator
