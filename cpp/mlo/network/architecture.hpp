#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/box.hpp"

namespace mlo {

/// What a 3DSSD network (Yang et al., CVPR 2020) is made of, and what it expects of its input. It is part of
/// the file of its weights, as JSON, so that published networks of full size and small ones of our own run by
/// the same code.

/// What each input point tells besides its position.
enum class PointFeature { intensity, height };

struct NetworkInputSpec {
  int max_points = 8192;  ///< the scan is thinned to at most so many
  std::vector<PointFeature> features = {PointFeature::height};
  double max_range_m = 70.0;   ///< points farther away, seen from above, are left out
  double min_height_m = -0.5;  ///< above the ground: what is lower is left out
  double max_height_m = 3.5;
  double sensor_height_m = 0.0;   ///< z of the input is the height above the ground minus this
  bool keeps_ground = false;      ///< whether points on the ground are part of the input
  double half_angle_deg = 180.0;  ///< azimuths within this of straight ahead; 180: all round
  int rings = 0;                  ///< of the lidar that it was trained with; 0: unknown
};

/// Farthest point sampling of some of a layer's input points.
struct SamplingSpec {
  enum class Method {
    distance,  ///< D-FPS: by their positions
    feature    ///< F-FPS: by positions and features together
  };
  Method method = Method::distance;
  int count = 0;
  int from = 0;  ///< of the points [from, to) in their order; to < 0: to the last
  int to = -1;
};

/// Neighbours within a ball, or between two balls, and the layers that describe them.
struct ScaleSpec {
  double inner_radius_m = 0.0;
  double radius_m = 0.0;
  int neighbours = 0;              ///< at most so many: the first in the order of the points
  std::vector<int> channels = {};  ///< outputs of each layer
};

struct SetAbstractionSpec {
  std::vector<SamplingSpec> samples = {};
  std::vector<ScaleSpec> scales = {};
  int aggregate = 0;  ///< channels of a last layer over all scales; 0: they are just put side by side
};

/// The candidate generation layer: the first points of the last layer are shifted towards the centres of the
/// objects that they may be on.
struct VoteSpec {
  int candidates = 256;
  std::vector<int> channels;
  Eigen::Vector3d max_shift_m{3.0, 3.0, 2.0};
};

struct HeadSpec {
  std::vector<int> shared, classes, boxes;
};

/// How a box is told: center, size, angle in bins.
struct BoxCodeSpec {
  bool center_in_sizes =
      true;              ///< offset in diagonals (x, y) and heights (z) of the class's mean size, else in m
  bool log_size = true;  ///< logarithm of the size over the class's mean, else half of each side in m
  int angle_bins = 12;
  double first_angle_rad = 0.0;  ///< middle of the first bin

  int size() const { return 6 + 2 * angle_bins; }
};

struct NetworkArchitecture {
  std::vector<ObjectClass> classes;
  std::vector<Eigen::Vector3d> mean_sizes_lwh_m;  ///< of each class
  double batch_norm_eps = 1e-5;
  NetworkInputSpec input;
  std::vector<SetAbstractionSpec> layers;
  VoteSpec vote;
  SetAbstractionSpec candidate_layer;  ///< without samples: its centres are the shifted candidates
  HeadSpec head;
  BoxCodeSpec box_code;

  int channels_in() const { return static_cast<int>(input.features.size()); }
};

/// Channels that a set abstraction layer gives.
int channels_out(const SetAbstractionSpec& layer);

/// @throws InputError naming what is missing or cannot be
NetworkArchitecture parse_architecture(std::string_view json);
std::string to_json(const NetworkArchitecture& architecture);

/// The small network that comes with the project: its weights are trained on simulated drives alone.
NetworkArchitecture small_architecture();

}  // namespace mlo
