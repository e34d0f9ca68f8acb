#include "mlo/pipeline/find_objects.hpp"

#include <filesystem>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/detection/cluster_detector.hpp"
#include "mlo/detection/network_detector.hpp"
#include "mlo/io/safetensors.hpp"
#include "mlo/perception/ground.hpp"
#include "mlo/pipeline/embedded_network.hpp"
#include "mlo/pipeline/prepare.hpp"

namespace mlo {

std::shared_ptr<const Network> load_network(const DetectionConfig& config) {
  if (config.detector != Detector::network) return nullptr;
  const std::filesystem::path file = config.network.weights;
  const std::string place = file.empty() ? "the weights that come with mlo" : file.string();
  try {
    return std::make_shared<const Network>(file.empty() ? parse_safetensors(embedded_network_weights(), place)
                                                        : read_safetensors(file));
  } catch (const InputError& e) {
    const std::string what = e.what();
    throw InputError(what.starts_with(place) ? what : fmt::format("{}: {}", place, what));
  }
}

std::vector<std::string> find_detector_problems(const Scan& scan, const PipelineConfig& config,
                                                const Network* network) {
  if (network == nullptr) return {};
  const Scan prepared = prepare(scan, config.sensor, config.input);
  const GroundSegmentation ground = segment_ground(prepared.points, config.perception.ground);
  const Eigen::Vector3f up_lidar = ground.found ? ground.nearby.normal : Eigen::Vector3f::UnitZ();
  return find_mismatches(prepared.points, up_lidar, network->architecture());
}

FoundObjects find_objects(const Scan& scan, const std::optional<FoundBefore>& before,
                          const PipelineConfig& config, const Network* network) {
  const Scan prepared = prepare(scan, config.sensor, config.input);
  const GroundSegmentation ground = segment_ground(prepared.points, config.perception.ground);
  return detect(prepared.points, ground.is_ground, before, config.detection, network);
}

std::vector<Candidate> find_object_candidates(const Scan& scan, const PipelineConfig& config) {
  const Scan prepared = prepare(scan, config.sensor, config.input);
  const GroundSegmentation ground = segment_ground(prepared.points, config.perception.ground);
  return find_candidates(prepared.points, ground.is_ground, config.detection.cluster);
}

}  // namespace mlo
