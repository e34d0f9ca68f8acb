#include <algorithm>
#include <vector>

#include "mlo/simulator/object_model.hpp"

namespace mlo::simulator {
namespace {

using Eigen::Vector3d;

/// Cross-section of a body at one place along it; fractions of length (from the middle), height and half
/// width.
struct Section {
  double x = 0.0;
  double bottom = 0.0, belt = 0.0, top = 0.0;  ///< of the height; windows lie between belt and top
  double top_width = 1.0;                      ///< of the width at the belt
  bool glass_sides = false;                    ///< from here to the next section
  bool glass_top = false;                      ///< windscreen or rear window from here to the next section
};

struct Dimensions {
  double length_m, width_m, height_m;
};

// Outline of a body: 0 and 7 at the bottom, 2 and 5 at the belt, 3 and 4 at the top.
Mesh body(const std::vector<Section>& sections, const Dimensions& size) {
  std::vector<Ring> rings;
  for (const Section& s : sections) {
    const double x = s.x * size.length_m;
    const double w = 0.5 * size.width_m;
    const double sill = s.bottom + 0.3 * (s.belt - s.bottom);
    Ring ring{{x, 0.9 * w, s.bottom},
              {x, w, sill},
              {x, 0.98 * w, s.belt},
              {x, s.top_width * w, s.top},
              {x, -s.top_width * w, s.top},
              {x, -0.98 * w, s.belt},
              {x, -w, sill},
              {x, -0.9 * w, s.bottom}};
    for (Vector3d& point : ring) point.z() *= size.height_m;
    rings.push_back(ring);
  }
  return loft(rings, true, [&](std::size_t i, std::size_t j) {
    const bool side_window = (j == 2 || j == 4) && sections[i].glass_sides;
    const bool screen = j == 3 && sections[i].glass_top;
    return side_window || screen ? Surface::glass : Surface::paint;
  });
}

Mesh wheels(const std::vector<double>& axles_m, const Dimensions& size, double radius_m, double tyre_m) {
  Mesh mesh;
  for (const double x : axles_m) {
    for (const double side : {-1.0, 1.0}) {
      const double outer = side * (0.5 * size.width_m - 0.02);
      mesh += tube({x, outer, radius_m}, {x, outer - side * tyre_m, radius_m}, radius_m, radius_m,
                   Surface::rubber, 12);
    }
  }
  return mesh;
}

Mesh number_plates(const Dimensions& size, double height_m) {
  Mesh mesh;
  for (const double side : {-1.0, 1.0}) {
    const double x = side * 0.5 * size.length_m;
    mesh += cuboid({x - 0.01, -0.26, height_m}, {x + 0.01, 0.26, height_m + 0.11}, Surface::sign);
  }
  return mesh;
}

std::vector<Section> hatchback() {
  return {{-0.50, .30, .48, .50, .90},
          {-0.485, .16, .56, .60, .90, false, true},
          {-0.36, .15, .62, .94, .78, true},
          {-0.22, .14, .62, .99, .76, true},
          {0.04, .14, .61, .985, .76, true, true},
          {0.22, .14, .60, .63, .90},
          {0.42, .14, .50, .53, .90},
          {0.485, .15, .40, .44, .88},
          {0.50, .22, .36, .38, .86}};
}

std::vector<Section> saloon() {
  return {{-0.50, .32, .52, .54, .90},
          {-0.485, .18, .60, .64, .92},
          {-0.36, .16, .63, .67, .88, false, true},
          {-0.22, .15, .64, .96, .76, true},
          {-0.08, .14, .63, 1.0, .76, true},
          {0.06, .14, .62, .985, .76, true, true},
          {0.22, .14, .60, .64, .88},
          {0.43, .15, .50, .54, .88},
          {0.485, .16, .40, .46, .88},
          {0.50, .24, .36, .38, .86}};
}

std::vector<Section> estate() {
  return {{-0.50, .28, .52, .54, .92},
          {-0.485, .16, .60, .63, .92, false, true},
          {-0.44, .15, .62, .92, .80, true},
          {-0.22, .14, .62, .99, .78, true},
          {0.05, .14, .61, 1.0, .78, true, true},
          {0.22, .14, .60, .64, .90},
          {0.43, .14, .50, .54, .90},
          {0.485, .15, .40, .46, .88},
          {0.50, .22, .36, .38, .86}};
}

std::vector<Section> box_van() {
  return {{-0.50, .18, .50, .96, .90},       {-0.485, .12, .50, 1.0, .92},
          {0.22, .11, .50, .995, .92, true}, {0.30, .11, .50, .96, .86, true, true},
          {0.41, .12, .46, .54, .90},        {0.485, .13, .36, .44, .90},
          {0.50, .18, .32, .36, .88}};
}

}  // namespace

ObjectModel make_car(Random random) {
  const int kind = random.integer(0, 2);
  const std::vector<Section> shape = kind == 0 ? hatchback() : kind == 1 ? saloon() : estate();
  const double base_m = kind == 0 ? 3.9 : 4.55;
  const Dimensions size{base_m + random.uniform(-0.25, 0.3), random.uniform(1.64, 1.84),
                        random.uniform(1.42, 1.56)};
  Mesh mesh = body(shape, size);
  mesh += wheels({-0.3 * size.length_m, 0.31 * size.length_m}, size, 0.31, 0.2);
  mesh += number_plates(size, 0.5);
  return make_model(ObjectClass::car, {{.mesh = mesh}});
}

ObjectModel make_van(Random random) {
  const Dimensions size{random.uniform(4.7, 5.6), random.uniform(1.85, 2.05), random.uniform(1.95, 2.45)};
  Mesh mesh = body(box_van(), size);
  mesh += wheels({-0.29 * size.length_m, 0.31 * size.length_m}, size, 0.34, 0.22);
  mesh += number_plates(size, 0.55);
  return make_model(ObjectClass::van, {{.mesh = mesh}});
}

ObjectModel make_truck(Random random) {
  const Dimensions size{random.uniform(8.0, 13.5), 2.5, random.uniform(3.3, 3.9)};
  const double half = 0.5 * size.length_m;
  const double cab_back = half - 2.3;
  Mesh mesh = cuboid({-half, -1.25, 1.05}, {cab_back - 0.5, 1.25, size.height_m}, Surface::paint);
  mesh += cuboid({-half + 0.1, -0.45, 0.75}, {cab_back, 0.45, 1.05}, Surface::rubber);  // frame
  const Dimensions cab{2.3, 2.45, 0.86 * size.height_m};
  const std::vector<Section> cab_shape{{-0.50, .17, .55, 1.0, .95, true},
                                       {0.30, .15, .55, .98, .94, true, true},
                                       {0.46, .15, .55, .62, .97},
                                       {0.50, .18, .52, .55, .95}};
  mesh += transformed(SE3(Eigen::Quaterniond::Identity(), {half - 1.15, 0.0, 0.0}), body(cab_shape, cab));
  mesh += wheels({-half + 1.6, -half + 2.9, half - 1.3}, size, 0.5, 0.32);
  mesh += cuboid({-half + 4.2, 1.0, 0.45}, {cab_back - 1.2, 1.2, 1.0}, Surface::paint);  // side guards
  mesh += cuboid({-half + 4.2, -1.2, 0.45}, {cab_back - 1.2, -1.0, 1.0}, Surface::paint);
  mesh += cuboid({-half, -1.1, 0.5}, {-half + 0.12, 1.1, 0.65}, Surface::paint);  // bumper
  return make_model(ObjectClass::truck, {{.mesh = mesh}});
}

ObjectModel make_carriage(double length_m) {
  const double half = 0.5 * length_m - 0.3;
  const auto ring = [&](double x, double inset) {
    const double w = 1.42 - inset;
    return Ring{
        {x, w, 0.9},  {x, w, 2.0},  {x, w, 2.9}, {x, 0.85 * w, 3.75 - inset}, {x, -0.85 * w, 3.75 - inset},
        {x, -w, 2.9}, {x, -w, 2.0}, {x, -w, 0.9}};
  };
  std::vector<Ring> rings{ring(-half - 0.3, 0.15), ring(-half, 0.0)};
  constexpr double kBay_m = 2.2;  // window, pillar, window, ...
  for (double x = -half + 0.6; x < half - 0.6; x += kBay_m) {
    rings.push_back(ring(x, 0.0));
    rings.push_back(ring(std::min(x + 1.5, half - 0.3), 0.0));
  }
  rings.push_back(ring(half, 0.0));
  rings.push_back(ring(half + 0.3, 0.15));
  Mesh mesh = loft(rings, true, [&](std::size_t i, std::size_t j) {
    const bool window = (j == 1 || j == 5) && i >= 2 && i + 3 < rings.size() && i % 2 == 0;
    return window ? Surface::glass : Surface::paint;
  });
  for (const double bogie : {-half + 3.0, half - 3.0}) {
    for (const double axle : {-1.2, 1.2}) {
      for (const double side : {-0.8, 0.65}) {
        mesh += tube({bogie + axle, side, 0.46}, {bogie + axle, side + 0.15, 0.46}, 0.46, 0.46, Surface::rail,
                     12);
      }
    }
    mesh += cuboid({bogie - 1.9, -1.1, 0.35}, {bogie + 1.9, 1.1, 0.85}, Surface::rail);
  }
  return make_model(ObjectClass::other, {{.mesh = mesh}});
}

}  // namespace mlo::simulator
