#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>

#include "mlo/io/dataset.hpp"
#include "mlo/io/detections.hpp"
#include "mlo/reproduction/reproduce.hpp"

namespace mlo {

/// How many scans a run up to this frame has.
std::size_t scans_up_to(const Dataset& dataset, std::size_t last_frame);

/// Runs the variant, unless the folder holds its finished run: one that was ended early, had other scans, or
/// is of another version, is done again.
/// @return false if it was stopped
/// @throws InputError as run()
bool run_unless_finished(const Dataset& dataset, const std::optional<DetectionList>& detections,
                         const Variant& variant, const std::filesystem::path& folder,
                         const ReproduceOptions& options, const ReproduceProgress& progress);

}  // namespace mlo
