#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "mlo/core/object_record.hpp"

namespace mlo {

/// What makes a track's box and a true box alike, as a number in [0, 1].
enum class Similarity {
  image_iou,       ///< intersection over union of image boxes
  box_iou,         ///< intersection over union of 3D boxes
  center_distance  ///< 1 - d / (2 max_distance) of the 3D centres, so that 0.5 is a distance of max_distance
};

/// What is compared and what is left out, as the KITTI tracking benchmark does.
struct TrackingProtocol {
  std::string object_class = "car";  ///< lower case, as in ObjectRecord::type
  Similarity similarity = Similarity::image_iou;
  double match_threshold = 0.5;  ///< least similarity of a match
  double max_distance_m = 2.0;   ///< see Similarity::center_distance
  // Truth beyond these is neither demanded nor held against a track.
  int max_truncation = 0;
  int max_occlusion = 2;
  double min_height_px = 25.0;  ///< unmatched tracks of no more height in the image are not counted
  double max_covered = 0.5;     ///< nor those of which a larger share lies in a DontCare region
};

/// Truth and tracks of one frame; ids count up from 0 within the sequence.
struct TrackingFrame {
  std::vector<std::size_t> truth_ids;
  std::vector<std::size_t> track_ids;
  Eigen::MatrixXd similarity;  ///< truth (rows) by tracks (columns)
};

/// What remains of one sequence to be scored by CLEAR MOT, HOTA and Identity.
struct TrackingSequence {
  std::vector<TrackingFrame> frames;  ///< frames without truth and tracks are left out
  std::size_t num_truth_ids = 0;
  std::size_t num_track_ids = 0;
  std::size_t num_truth_boxes = 0;
  std::size_t num_track_boxes = 0;
};

/// Types that KITTI's protocols do not tell apart from a class reliably: neither demanded nor held against
/// it.
std::vector<std::string> neighbors_of(const std::string& object_class);

double similarity_of(const ObjectRecord& a, const ObjectRecord& b, const TrackingProtocol& protocol);

/// Records of one frame that take part for a class: its own, those of neighbouring classes (which are not
/// told apart reliably: vans for cars, sitting persons for pedestrians) and the DontCare regions of the
/// truth.
struct RecordFrame {
  std::vector<const ObjectRecord*> truth;
  std::vector<const ObjectRecord*> tracks;
  std::vector<Box2d> dont_care;
};

/// Groups records by frame, in the order of the frames. The result points into the records.
/// @param neighbors  types that take part besides protocol.object_class
/// @throws InputError if an id occurs twice in a frame, in truth or tracks
std::vector<RecordFrame> group_by_frame(std::span<const ObjectRecord> truth,
                                        std::span<const ObjectRecord> tracks, const std::string& object_class,
                                        std::span<const std::string> neighbors);

/// Truth (rows) by tracks (columns).
Eigen::MatrixXd similarities(const RecordFrame& frame, const TrackingProtocol& protocol);

/// True if protocol and kind of object leave the truth record out of the score.
bool is_ignored(const ObjectRecord& truth, const TrackingProtocol& protocol);

/// True if an unmatched track record is too small in the image, or lies in a DontCare region.
bool is_excused(const ObjectRecord& track, std::span<const Box2d> dont_care,
                const TrackingProtocol& protocol);

/// Applies the rules of TrackEval's KITTI protocol (Luiten et al., IJCV 2021; kitti_2d_box.py) to one
/// sequence: truth and tracks of the class and its neighbours are matched; tracks matched to truth that is
/// ignored, and unmatched ones that are excused, are removed; then the ignored truth is.
/// @throws InputError if an id occurs twice in a frame
TrackingSequence prepare_tracking(std::span<const ObjectRecord> truth, std::span<const ObjectRecord> tracks,
                                  const TrackingProtocol& protocol);

}  // namespace mlo
