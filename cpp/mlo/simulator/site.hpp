#pragma once

#include <unordered_map>
#include <vector>

#include <Eigen/Core>

#include "mlo/simulator/mesh.hpp"
#include "mlo/simulator/path.hpp"
#include "mlo/simulator/terrain.hpp"

namespace mlo::simulator {

/// A rectangle on the ground.
struct Footprint {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  double yaw_rad = 0.0;
  double length_m = 0.0;  ///< along the yaw
  double width_m = 0.0;
};

/// True if the rectangles, grown by half of margin_m each, share a point.
bool overlap(const Footprint& a, const Footprint& b, double margin_m = 0.0);

/// The plan of a scene: roads, and what ground is taken.
class Site {
 public:
  /// A road of constant width; sidewalks beyond it if sidewalk_m > 0.
  /// @return the road's number
  std::size_t add_road(const Path& centerline, double half_width_m, double sidewalk_m = 0.0);
  /// True if nothing stands there and no road or sidewalk passes.
  bool is_free(const Footprint& footprint) const;
  void take(const Footprint& footprint) { taken_.push_back(footprint); }

  std::size_t roads() const { return roads_.size(); }
  /// True within margin_m of the edge of any road but the one given.
  bool near_another_road(const Eigen::Vector2d& p_world, std::size_t road, double margin_m) const;
  Surface surface_at(const Eigen::Vector2d& p_world) const;

  /// The ground within reach_m of the way: a grid of cell_m, rough where there is neither road nor sidewalk.
  Mesh ground(const Terrain& terrain, const Path& way, double reach_m, double cell_m, double roughness_m,
              std::uint64_t seed) const;
  /// Kerbs and raised sidewalks of all roads, with gaps where another road passes.
  Mesh sidewalks(const Terrain& terrain) const;

  static constexpr double kKerb_m = 0.12;

 private:
  struct Road {
    Path centerline;
    double half_width_m;
    double sidewalk_m;
  };
  struct Sample {
    Eigen::Vector2d p_world;
    double half_width_m;
    double sidewalk_m;
    std::size_t road;
  };
  static std::int64_t cell_key(int x, int y);
  template <class Visit>
  void visit_samples_near(const Eigen::Vector2d& p_world, const Visit& visit) const;

  std::vector<Road> roads_;
  std::unordered_map<std::int64_t, std::vector<Sample>> samples_;  // by cell of kCell_m
  std::vector<Footprint> taken_;
  static constexpr double kCell_m = 16.0;  // longer than half of the widest road with sidewalk
  static constexpr double kSampleStep_m = 1.0;
};

/// A strip of constant cross-section along a path, standing on the terrain.
/// @param profile  (left of the path, up) points [m]; one surface per gap between them
Mesh extrude(const Terrain& terrain, const Path& path, const std::vector<Eigen::Vector2d>& profile,
             const std::vector<Surface>& surfaces, double step_m);

}  // namespace mlo::simulator
