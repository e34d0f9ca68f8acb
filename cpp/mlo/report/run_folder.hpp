#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "mlo/core/object_pose.hpp"
#include "mlo/core/types.hpp"
#include "mlo/io/dataset.hpp"

namespace mlo {

/// Times of one stage of the pipeline.
struct StageSeries {
  std::string name;
  std::vector<double> ms;  ///< one per scan, NaN where it was skipped
  double mean_ms = 0.0;
  double p50_ms = 0.0;
  double p99_ms = 0.0;
  double max_ms = 0.0;
};

/// What a folder of `mlo run` holds.
struct RunFolder {
  std::string name;  ///< of the folder
  std::string version;
  std::string input_folder;
  std::string input_format;
  std::string input_sequence;
  std::string boxes_from;  ///< what found the objects: given, none or the detector
  /// Numbers of run.json by their names, in its order.
  std::vector<std::pair<std::string, double>> counters;
  std::vector<std::string> warnings;
  std::vector<std::string> problems;  ///< why scans were skipped: "frame N: ..."
  std::vector<StageSeries> stages;    ///< in the order of the pipeline
  StageSeries whole_scan;             ///< statistics only
  std::vector<double> frames;         ///< x axis of the stages' series
  PoseList trajectory;
  std::vector<MapPoint> map;        ///< empty where there is no static_map.ply
  std::vector<ObjectPose> objects;  ///< empty where there is no objects.csv
};

/// Reads run.json, per_scan.csv and trajectory.txt, which must be there, and static_map.ply and objects.csv.
/// @throws InputError naming the file that is missing or cannot be understood
RunFolder read_run_folder(const std::filesystem::path& folder);

}  // namespace mlo
