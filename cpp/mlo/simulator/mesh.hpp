#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "mlo/core/random.hpp"
#include "mlo/core/se3.hpp"

namespace mlo::simulator {

/// What a triangle is made of: decides its reflectance, how much light it swallows, and the label of static
/// points.
enum class Surface : std::uint8_t {
  road,
  sidewalk,
  grass,
  wall,
  window,
  roof,
  leaf,
  bark,
  pole,
  sign,
  barrier,
  rail,
  paint,
  glass,
  rubber,
  cloth,
  skin
};

struct Triangle {
  std::array<std::uint32_t, 3> corners;
  Surface surface;
};

/// Triangles in their own frame [m].
struct Mesh {
  std::vector<Eigen::Vector3f> vertices;
  std::vector<Triangle> triangles;

  Mesh& operator+=(const Mesh& other);
  Eigen::AlignedBox3d bounds() const;
};

Mesh transformed(const SE3& T_target_source, Mesh mesh);

/// Corners in order around the face.
Mesh quad(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
          const Eigen::Vector3d& d, Surface surface);
Mesh cuboid(const Eigen::Vector3d& min, const Eigen::Vector3d& max, Surface surface);
/// A rod with round caps cut flat; the radii at both ends may differ.
Mesh tube(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double radius_from_m, double radius_to_m,
          Surface surface, int sides = 8);
Mesh ellipsoid(const Eigen::Vector3d& center, const Eigen::Vector3d& radii_m, Surface surface);

using Ring = std::vector<Eigen::Vector3d>;
/// Skin over rings of equally many points, with flat caps at both ends if they are `closed`.
/// @param surface  of the strip between rings i and i + 1, from point j to the next; caps take (ring, 0)
Mesh loft(const std::vector<Ring>& rings, bool closed,
          const std::function<Surface(std::size_t ring, std::size_t point)>& surface);

/// Small square leaves at random places and directions inside an ellipsoid: what a lidar sees of a crown or
/// bush.
Mesh foliage(const Eigen::Vector3d& center, const Eigen::Vector3d& radii_m, int leaves, double leaf_size_m,
             Random random);

}  // namespace mlo::simulator
