#pragma once

#include <filesystem>
#include <string>

#include "mlo/io/point_cloud_file.hpp"
#include "temp_folder.hpp"

namespace mlo::test {

/// A small folder as `mlo run` writes it: three scans ahead, the second skipped.
inline std::filesystem::path write_run(const TempFolder& folder, const std::string& name) {
  folder.write(name + "/run.json", R"({
  "version": "0.1.0",
  "input": {"folder": "scans/04", "format": "kitti_odometry", "sequence": "04"},
  "scans": 3, "processed": 2, "skipped": 1, "path_m": 2.5, "interrupted": false, "boxes_from": "cluster",
  "times": {"perception": {"mean_ms": 10.0, "p50_ms": 9.0, "p99_ms": 12.0, "max_ms": 13.0},
            "scan": {"mean_ms": 20.0, "p50_ms": 19.0, "p99_ms": 22.0, "max_ms": 23.0}},
  "warnings": ["something <odd> & strange"]
})");
  folder.write(name + "/per_scan.csv",
               "frame,stamp_s,status,perception_ms,problem\n"
               "0,0.0,first,9.50,\n"
               "1,,skipped,,\"000001.bin: 3 bytes, not whole\"\n"
               "2,0.2,localised,10.50,\n");
  std::string rows;
  for (int i = 0; i < 3; ++i) rows += "1 0 0 " + std::to_string(10 * i) + " 0 1 0 0 0 0 1 0\n";
  folder.write(name + "/trajectory.txt", rows);
  std::vector<MapPoint> map;
  for (int i = 0; i < 200; ++i) {
    map.push_back({{0.1F * static_cast<float>(i), 3.0F, 0.0F}, 0.0F, MapLabel::ground});
    map.push_back({{0.1F * static_cast<float>(i), 8.0F, 1.0F}, 0.0F, MapLabel::surface});
  }
  write_ply(folder.path() / name / "static_map.ply", map);
  return folder.path() / name;
}

}  // namespace mlo::test
