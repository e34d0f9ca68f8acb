#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include "apps/program.hpp"
#include "io/synthetic_sweep.hpp"

namespace mlo {

/// KITTI odometry layout: a lidar that stands in a room for four scans.
inline std::filesystem::path room_sequence() {
  const std::filesystem::path sequence = fresh_folder() / "04";
  std::filesystem::create_directories(sequence / "velodyne");
  const std::string scan = test::to_bin(test::make_sweep({.sensor = hdl64e(), .columns = 300}));
  for (int i = 0; i < 4; ++i) {
    std::ofstream(sequence / "velodyne" / ("00000" + std::to_string(i) + ".bin"), std::ios::binary) << scan;
  }
  std::ofstream(sequence / "times.txt") << "0.0\n0.1\n0.2\n0.3\n";
  std::ofstream(sequence / "calib.txt") << "P0: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "P1: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "P2: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "P3: 700 0 600 0 0 700 180 0 0 0 1 0\n"
                                        << "Tr: 0 -1 0 0 0 0 -1 -0.1 1 0 0 -0.3\n";
  return sequence;
}

}  // namespace mlo
