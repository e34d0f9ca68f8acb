#pragma once

#include <optional>
#include <vector>

#include "mlo/core/types.hpp"
#include "mlo/detection/candidates.hpp"
#include "mlo/detection/detect.hpp"
#include "mlo/pipeline/config.hpp"

namespace mlo {

/// What the detector of the configuration finds in a scan, as a run would: points that are not used are left
/// out first, then the ground is.
/// @param before  what the scan before left; nothing: the scan is judged by itself
FoundObjects find_objects(const Scan& scan, const std::optional<FoundBefore>& before,
                          const PipelineConfig& config);

/// What the cluster detector judges, unjudged: for fitting its model.
std::vector<Candidate> find_object_candidates(const Scan& scan, const PipelineConfig& config);

}  // namespace mlo
