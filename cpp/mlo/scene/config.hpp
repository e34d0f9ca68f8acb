#pragma once

#include "mlo/core/fields.hpp"

namespace mlo {

/// The 4D file that a run writes.
struct SceneConfig {
  bool write = true;
  bool clouds = true;
  double cloud_voxel_m = 0.4;
  int compression_level = 1;

  template <class Visitor>
  void fields(Visitor& visit) {
    visit("write", write, Anything{}, "false: a run writes no scene.mlo");
    visit("clouds", clouds, Anything{},
          "true: it holds what each scan saw; false: poses, objects and map only");
    visit("cloud_voxel_m", cloud_voxel_m, between(0.01, 10.0),
          "the environment in it is thinned to one point per voxel and scan: detail against size [m]");
    visit("compression_level", compression_level, between(1, 19), "of zstd: size against time");
  }
};

}  // namespace mlo
