#pragma once

#include <filesystem>

#include "mlo/simulator/simulate.hpp"

namespace mlo::test {

/// Simulates the begin of a drive with half the columns of the real sensor, which halves all times.
inline void simulate_drive(const simulator::SceneOptions& scene, std::size_t scans,
                           const std::filesystem::path& out) {
  simulator::SimulationOptions options;
  options.scene = scene;
  options.sensor.columns = 1080;
  options.detector.max_range_m = 1000.0;  // all that is labelled
  options.max_scans = scans;
  options.version = "test";
  simulator::simulate(options, out, {});
}

}  // namespace mlo::test
