#pragma once

#include <array>
#include <cstddef>
#include <map>
#include <string>

#include "mlo/scene/scene_file.hpp"

namespace mlo {

/// What a scene holds, in numbers.
struct SceneSummary {
  std::size_t scans = 0;
  std::array<std::size_t, kNumScanStatuses> by_status{};  ///< scans of each ScanStatus
  double first_stamp_s = 0.0;
  double last_stamp_s = 0.0;
  double path_m = 0.0;
  std::map<std::string, std::size_t> objects;  ///< identities of each class
  std::size_t objects_moving = 0;              ///< identities that moved in more scans than they stood
  std::size_t map_points = 0;
};

/// Reads all scans and the map, but no clouds.
SceneSummary summarize(const SceneFile& scene);

}  // namespace mlo
