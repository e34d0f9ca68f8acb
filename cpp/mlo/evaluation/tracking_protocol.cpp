#include "mlo/evaluation/tracking_protocol.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "mlo/core/assignment.hpp"
#include "mlo/core/box_overlap.hpp"
#include "mlo/core/error.hpp"
#include "mlo/evaluation/measures.hpp"

namespace mlo {
namespace {

constexpr const char* kDontCare = "dontcare";

bool takes_part(const ObjectRecord& record, const std::string& object_class,
                std::span<const std::string> neighbors) {
  if (record.track_id < 0) return false;
  return record.type == object_class ||
         std::find(neighbors.begin(), neighbors.end(), record.type) != neighbors.end();
}

void require_unique_ids(std::span<const ObjectRecord* const> records, const char* what) {
  std::set<long> ids;
  for (const ObjectRecord* record : records) {
    if (ids.insert(record->track_id).second) continue;
    throw InputError(fmt::format("frame {}: {} {} occurs twice; an id may stand only once in a frame",
                                 record->frame, what, record->track_id));
  }
}

// Ids as they come, counted up from 0.
class Renumbering {
 public:
  std::size_t number(long id) { return numbers_.emplace(id, numbers_.size()).first->second; }
  std::size_t size() const { return numbers_.size(); }

 private:
  std::map<long, std::size_t> numbers_;
};

// Which tracks stay: not those matched to ignored truth, nor unmatched ones that are excused.
std::vector<bool> tracks_that_count(const RecordFrame& frame, const Eigen::MatrixXd& similarity,
                                    const TrackingProtocol& protocol) {
  const auto matchable = (similarity.array() >= protocol.match_threshold - kEpsilon);
  const Eigen::MatrixXd score = matchable.select(similarity, 0.0);
  std::vector<bool> counts(frame.tracks.size());
  for (std::size_t i = 0; i < counts.size(); ++i)
    counts[i] = !is_excused(*frame.tracks[i], frame.dont_care, protocol);
  for (const auto& [row, col] : optimal_assignment(-score)) {
    if (score(row, col) <= kEpsilon) continue;
    counts[static_cast<std::size_t>(col)] =
        !is_ignored(*frame.truth[static_cast<std::size_t>(row)], protocol);
  }
  return counts;
}

}  // namespace

std::vector<std::string> neighbors_of(const std::string& object_class) {
  if (object_class == "car") return {"van"};
  if (object_class == "pedestrian") return {"person", "person_sitting"};
  return {};
}

double similarity_of(const ObjectRecord& a, const ObjectRecord& b, const TrackingProtocol& protocol) {
  switch (protocol.similarity) {
    case Similarity::image_iou:
      return intersection_over_union(a.image_box, b.image_box);
    case Similarity::box_iou:
      return intersection_over_union(a.box, b.box);
    case Similarity::center_distance:
      break;
  }
  const double distance_m = (a.box.center_lidar_m - b.box.center_lidar_m).norm();
  return std::max(0.0, 1.0 - distance_m / (2.0 * protocol.max_distance_m));
}

Eigen::MatrixXd similarities(const RecordFrame& frame, const TrackingProtocol& protocol) {
  Eigen::MatrixXd similarity(frame.truth.size(), frame.tracks.size());
  for (Eigen::Index row = 0; row < similarity.rows(); ++row) {
    for (Eigen::Index col = 0; col < similarity.cols(); ++col) {
      similarity(row, col) = similarity_of(*frame.truth[static_cast<std::size_t>(row)],
                                           *frame.tracks[static_cast<std::size_t>(col)], protocol);
    }
  }
  return similarity;
}

std::vector<RecordFrame> group_by_frame(std::span<const ObjectRecord> truth,
                                        std::span<const ObjectRecord> tracks, const std::string& object_class,
                                        std::span<const std::string> neighbors) {
  std::map<std::size_t, RecordFrame> frames;
  for (const ObjectRecord& record : truth) {
    if (record.type == kDontCare) {
      frames[record.frame].dont_care.push_back(record.image_box);
    } else if (takes_part(record, object_class, neighbors)) {
      frames[record.frame].truth.push_back(&record);
    }
  }
  for (const ObjectRecord& record : tracks) {
    if (takes_part(record, object_class, neighbors)) frames[record.frame].tracks.push_back(&record);
  }
  std::vector<RecordFrame> in_order;
  for (auto& [number, frame] : frames) {
    require_unique_ids(frame.truth, "true object");
    require_unique_ids(frame.tracks, "track");
    in_order.push_back(std::move(frame));
  }
  return in_order;
}

bool is_ignored(const ObjectRecord& truth, const TrackingProtocol& protocol) {
  return truth.type != protocol.object_class || truth.occlusion > protocol.max_occlusion ||
         truth.truncation > protocol.max_truncation;
}

bool is_excused(const ObjectRecord& track, std::span<const Box2d> dont_care,
                const TrackingProtocol& protocol) {
  if (track.image_box.bottom_px - track.image_box.top_px <= protocol.min_height_px + kEpsilon) return true;
  return std::any_of(dont_care.begin(), dont_care.end(), [&](const Box2d& region) {
    return covered_fraction(track.image_box, region) > protocol.max_covered + kEpsilon;
  });
}

TrackingSequence prepare_tracking(std::span<const ObjectRecord> truth, std::span<const ObjectRecord> tracks,
                                  const TrackingProtocol& protocol) {
  TrackingSequence sequence;
  Renumbering truth_numbers;
  Renumbering track_numbers;
  for (RecordFrame& records :
       group_by_frame(truth, tracks, protocol.object_class, neighbors_of(protocol.object_class))) {
    std::erase_if(records.tracks,
                  [&](const ObjectRecord* record) { return record->type != protocol.object_class; });
    const Eigen::MatrixXd similarity = similarities(records, protocol);
    const std::vector<bool> counts = tracks_that_count(records, similarity, protocol);
    TrackingFrame frame;
    std::vector<Eigen::Index> rows;
    std::vector<Eigen::Index> cols;
    for (std::size_t i = 0; i < records.truth.size(); ++i) {
      if (is_ignored(*records.truth[i], protocol)) continue;
      rows.push_back(static_cast<Eigen::Index>(i));
      frame.truth_ids.push_back(truth_numbers.number(records.truth[i]->track_id));
    }
    for (std::size_t i = 0; i < records.tracks.size(); ++i) {
      if (!counts[i]) continue;
      cols.push_back(static_cast<Eigen::Index>(i));
      frame.track_ids.push_back(track_numbers.number(records.tracks[i]->track_id));
    }
    frame.similarity = similarity(rows, cols);
    sequence.num_truth_boxes += rows.size();
    sequence.num_track_boxes += cols.size();
    if (!rows.empty() || !cols.empty()) sequence.frames.push_back(std::move(frame));
  }
  sequence.num_truth_ids = truth_numbers.size();
  sequence.num_track_ids = track_numbers.size();
  return sequence;
}

}  // namespace mlo
