#pragma once

#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "mlo/core/types.hpp"

namespace mlo {

/// What the rays of one scan say about a place.
enum class Sight {
  unknown,  ///< no ray came near, or it ended in front
  hit,      ///< a ray ended there
  through,  ///< the rays around went on beyond
  empty,    ///< none of the rays around came back: far away, or what reflects nothing
  sky       ///< nor did any above them: nothing is there
};

/// The ranges of one scan by direction, as they were measured: for questions of what was free.
class RangeImage {
 public:
  /// @param points  of one scan, finite, lidar frame at their own times [m]; rows of the image are as high as
  ///                the scan lines are apart, columns a little wider than their points
  explicit RangeImage(std::span<const Point> points);

  /// When in the sweep the lidar looked in a direction: the mean of its column; 0.5 where nothing was
  /// measured.
  float sweep_fraction(const Eigen::Vector3f& p_lidar) const;

  /// How far apart neighbouring scan lines lie on a horizontal surface through a place below the lidar.
  float step_on_ground_m(const Eigen::Vector3f& p_lidar) const {
    return p_lidar.squaredNorm() / (inverse_row_height_ * std::max(0.5F, -p_lidar.z()));
  }

  /// Whether the rays ended at a place or went through it. Through needs all rays of the pixel and of those
  /// beside it, so that the rim of a nearer surface does not look free; nor may a ray just below have ended
  /// shortly before, as on a roof or bonnet over which the lidar can just see.
  /// @param p_lidar   lidar frame at the time the lidar looked there [m]
  /// @param margin_m  how far ranges may differ and still mean the same place
  Sight look(const Eigen::Vector3f& p_lidar, float margin_m) const;

  static void archive(auto& self, auto& bytes) {  // core/archive.hpp
    bytes(self.lowest_tangent_, self.inverse_row_height_, self.rows_, self.columns_, self.pixels_,
          self.sweep_fractions_, self.top_rows_);
  }

 private:
  struct Pixel {
    float nearest_m = 0.0F;  // 0: no ray
    float farthest_m = 0.0F;
    static void archive(auto& self, auto& bytes) { bytes(self.nearest_m, self.farthest_m); }
  };
  void set_size(std::span<const Point> points);
  int column(const Eigen::Vector3f& p_lidar) const;
  int row(const Eigen::Vector3f& p_lidar) const;
  const Pixel& at(int row, int column) const;
  bool is_empty_around(int row, int column) const;
  bool is_sky(int row, int column) const;

  float lowest_tangent_ = 0.0F;  // of the elevation
  float inverse_row_height_ = 0.0F;
  int rows_ = 0;
  int columns_ = 1;
  std::vector<Pixel> pixels_;           // row by row
  std::vector<float> sweep_fractions_;  // of each column
  std::vector<int> top_rows_;           // the highest with a ray in each column, -1 without
};

}  // namespace mlo
