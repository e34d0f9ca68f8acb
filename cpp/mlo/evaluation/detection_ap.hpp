#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "mlo/core/box.hpp"

namespace mlo {

/// A true box and what makes it hard to see.
struct LabelledBox {
  std::string type;  ///< lower case, as in ObjectRecord
  Box3d box;
  double height_px = 0.0;  ///< in the image
  int occlusion = 0;       ///< 0 fully visible, 1 partly, 2 largely hidden, 3 unknown
  int truncation = 0;      ///< 0 none, 1 partly, 2 largely outside the image
};

/// A box of a detector.
struct ScoredBox {
  std::string type;
  Box3d box;
  double confidence = 0.0;  ///< of any scale: only the order counts
  double height_px = 0.0;
};

struct DetectionFrame {
  std::vector<LabelledBox> truth;
  std::vector<ScoredBox> detections;
};

/// KITTI's grades; each takes in the easier ones.
enum class Difficulty { easy, moderate, hard };
inline constexpr std::array kDifficulties{Difficulty::easy, Difficulty::moderate, Difficulty::hard};

/// What a detection and a true box share, as intersection over union.
enum class BoxOverlap { volume, footprint };

struct DetectionProtocol {
  std::string object_class = "car";
  BoxOverlap overlap = BoxOverlap::volume;
  double min_overlap = 0.7;  ///< a match shares more than this
};

struct AveragePrecision {
  static constexpr std::size_t kRecallPoints = 40;

  double ap = 0.0;                                   ///< mean of the precisions, in [0, 1]; 0 without truth
  std::size_t num_truth = 0;                         ///< that is demanded
  std::array<double, kRecallPoints> precision = {};  ///< best at recall (i + 1) / 40 or more
  double recall = 0.0;                               ///< of all detections, whatever their confidence
};

/// Average precision of KITTI's object benchmark at 40 recall points (Simonelli et al., ICCV 2019), counted
/// as its development kit does (evaluate_object.cpp): neighbouring classes and truth beyond the difficulty
/// are neither demanded nor held against a detection, detections too small in the image are not counted.
AveragePrecision average_precision(std::span<const DetectionFrame> frames, const DetectionProtocol& protocol,
                                   Difficulty difficulty);

/// Of the truth whose centre lies from from_m to to_m of the lidar, seen from above.
struct RangeRecall {
  double from_m = 0.0;
  double to_m = 0.0;
  std::size_t truth = 0;
  std::size_t found = 0;
};

/// Recall by range of the detections with at least some confidence, matched as above.
/// @param borders_m  growing; one bin between neighbours
std::vector<RangeRecall> recall_by_range(std::span<const DetectionFrame> frames,
                                         const DetectionProtocol& protocol, Difficulty difficulty,
                                         std::span<const double> borders_m, double min_confidence);

}  // namespace mlo
