#include "mlo/pipeline/find_objects.hpp"

#include "mlo/detection/cluster_detector.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/pipeline/prepare.hpp"

namespace mlo {

FoundObjects find_objects(const Scan& scan, const std::optional<FoundBefore>& before,
                          const PipelineConfig& config) {
  const Scan prepared = prepare(scan, config.sensor, config.input);
  const GroundSegmentation ground = segment_ground(prepared.points, config.perception.ground);
  return detect(prepared.points, ground.is_ground, before, config.detection);
}

std::vector<Candidate> find_object_candidates(const Scan& scan, const PipelineConfig& config) {
  const Scan prepared = prepare(scan, config.sensor, config.input);
  const GroundSegmentation ground = segment_ground(prepared.points, config.perception.ground);
  return find_candidates(prepared.points, ground.is_ground, config.detection.cluster);
}

}  // namespace mlo
