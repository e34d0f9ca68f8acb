#include "mlo/simulator/mesh.hpp"

#include <cmath>
#include <numbers>

namespace mlo::simulator {
namespace {

using Eigen::Vector3d;

void add_triangle(Mesh& mesh, std::size_t a, std::size_t b, std::size_t c, Surface surface) {
  mesh.triangles.push_back(
      {{static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)},
       surface});
}

void add_cap(Mesh& mesh, std::size_t first, std::size_t count, Surface surface) {
  for (std::size_t j = 1; j + 1 < count; ++j) add_triangle(mesh, first, first + j, first + j + 1, surface);
}

Vector3d random_direction(Random& random) {
  const double z = random.uniform(-1.0, 1.0);
  const double angle = random.uniform(0.0, 2.0 * std::numbers::pi);
  const double r = std::sqrt(1.0 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

}  // namespace

Mesh& Mesh::operator+=(const Mesh& other) {
  const auto offset = static_cast<std::uint32_t>(vertices.size());
  vertices.insert(vertices.end(), other.vertices.begin(), other.vertices.end());
  triangles.reserve(triangles.size() + other.triangles.size());
  for (Triangle triangle : other.triangles) {
    for (std::uint32_t& corner : triangle.corners) corner += offset;
    triangles.push_back(triangle);
  }
  return *this;
}

Eigen::AlignedBox3d Mesh::bounds() const {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3f& vertex : vertices) box.extend(vertex.cast<double>());
  return box;
}

Mesh transformed(const SE3& T_target_source, Mesh mesh) {
  for (Eigen::Vector3f& vertex : mesh.vertices) {
    vertex = (T_target_source * vertex.cast<double>()).cast<float>();
  }
  return mesh;
}

Mesh quad(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& d, Surface surface) {
  Mesh mesh;
  for (const Vector3d& corner : {a, b, c, d}) mesh.vertices.push_back(corner.cast<float>());
  add_cap(mesh, 0, 4, surface);
  return mesh;
}

Mesh cuboid(const Vector3d& min, const Vector3d& max, Surface surface) {
  const auto ring = [&](double x) {
    return Ring{{x, min.y(), min.z()}, {x, max.y(), min.z()}, {x, max.y(), max.z()}, {x, min.y(), max.z()}};
  };
  return loft({ring(min.x()), ring(max.x())}, true, [=](std::size_t, std::size_t) { return surface; });
}

Mesh tube(const Vector3d& from, const Vector3d& to, double radius_from_m, double radius_to_m, Surface surface,
          int sides) {
  const Vector3d axis = (to - from).normalized();
  const Vector3d helper = std::abs(axis.z()) < 0.9 ? Vector3d::UnitZ().eval() : Vector3d::UnitX().eval();
  const Vector3d u = axis.cross(helper).normalized();
  const Vector3d v = axis.cross(u);
  const auto ring = [&](const Vector3d& center, double radius) {
    Ring points;
    for (int j = 0; j < sides; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / sides;
      points.push_back(center + radius * (std::cos(angle) * u + std::sin(angle) * v));
    }
    return points;
  };
  return loft({ring(from, radius_from_m), ring(to, radius_to_m)}, true,
              [=](std::size_t, std::size_t) { return surface; });
}

Mesh ellipsoid(const Vector3d& center, const Vector3d& radii_m, Surface surface) {
  constexpr int kBands = 7;
  constexpr int kSides = 10;
  std::vector<Ring> rings;
  for (int i = 0; i <= kBands; ++i) {
    // the poles are tiny rings, so that every ring has the same number of points
    const double polar = std::numbers::pi * (0.02 + 0.96 * i / kBands);
    Ring ring;
    for (int j = 0; j < kSides; ++j) {
      const double angle = 2.0 * std::numbers::pi * j / kSides;
      const Vector3d unit(std::sin(polar) * std::cos(angle), std::sin(polar) * std::sin(angle),
                          std::cos(polar));
      ring.push_back(center + radii_m.cwiseProduct(unit));
    }
    rings.push_back(ring);
  }
  return loft(rings, true, [=](std::size_t, std::size_t) { return surface; });
}

Mesh loft(const std::vector<Ring>& rings, bool closed,
          const std::function<Surface(std::size_t, std::size_t)>& surface) {
  Mesh mesh;
  if (rings.empty()) return mesh;
  const std::size_t count = rings.front().size();
  const std::size_t strips = closed ? count : count - 1;
  for (const Ring& ring : rings) {
    for (const Vector3d& point : ring) mesh.vertices.push_back(point.cast<float>());
  }
  for (std::size_t i = 0; i + 1 < rings.size(); ++i) {
    for (std::size_t j = 0; j < strips; ++j) {
      const std::size_t a = i * count + j;
      const std::size_t b = i * count + (j + 1) % count;
      add_triangle(mesh, a, b, b + count, surface(i, j));
      add_triangle(mesh, a, b + count, a + count, surface(i, j));
    }
  }
  if (closed) {
    add_cap(mesh, 0, count, surface(0, 0));
    add_cap(mesh, (rings.size() - 1) * count, count, surface(rings.size() - 1, 0));
  }
  return mesh;
}

Mesh foliage(const Vector3d& center, const Vector3d& radii_m, int leaves, double leaf_size_m, Random random) {
  Mesh mesh;
  for (int i = 0; i < leaves; ++i) {
    // denser towards the skin of the crown, where the light is
    const double depth = std::pow(random.uniform(), 0.22);
    const Vector3d direction = random_direction(random);
    const Vector3d place = center + depth * radii_m.cwiseProduct(direction);
    const Vector3d u = random_direction(random) * (0.5 * leaf_size_m * random.uniform(0.6, 1.4));
    const Vector3d v = u.cross(random_direction(random)) * random.uniform(0.7, 1.0) / 0.7;
    mesh += quad(place - u - v, place + u - v, place + u + v, place - u + v, Surface::leaf);
  }
  return mesh;
}

}  // namespace mlo::simulator
