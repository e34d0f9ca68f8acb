#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "mlo/core/types.hpp"
#include "mlo/detection/candidates.hpp"
#include "mlo/detection/detect.hpp"
#include "mlo/pipeline/config.hpp"

namespace mlo {

/// The network of the configuration, or the one that comes with mlo; nothing if its detector needs none.
/// @throws InputError if the weights cannot be read or are not of a network
std::shared_ptr<const Network> load_network(const DetectionConfig& config);

/// Why the detector of the configuration will do badly on scans like this one, a sentence with a remedy each.
std::vector<std::string> find_detector_problems(const Scan& scan, const PipelineConfig& config,
                                                const Network* network);

/// What the detector of the configuration finds in a scan, as a run would: points that are not used are left
/// out first, then the ground is.
/// @param before   what the scan before left; nothing: the scan is judged by itself
/// @param network  that of load_network()
FoundObjects find_objects(const Scan& scan, const std::optional<FoundBefore>& before,
                          const PipelineConfig& config, const Network* network = nullptr);

/// What the cluster detector judges, unjudged: for fitting its model.
std::vector<Candidate> find_object_candidates(const Scan& scan, const PipelineConfig& config);

}  // namespace mlo
