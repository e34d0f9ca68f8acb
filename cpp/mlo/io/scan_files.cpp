#include "mlo/io/scan_files.hpp"

#include <utility>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/sweep_structure.hpp"
#include "mlo/io/velodyne_bin.hpp"

namespace mlo {

ScanFiles::ScanFiles(std::vector<ScanFile> files, ScanFileTraits traits)
    : files_(std::move(files)), traits_(std::move(traits)) {}

ScanReading ScanFiles::read(std::size_t index) const {
  const ScanFile& file = files_.at(index);
  ScanReading reading;
  if (!std::filesystem::exists(file.path)) {
    reading.problem = fmt::format("{}: the scan is missing", file.path.string());
    return reading;
  }
  try {
    BinPoints content = read_velodyne_bin(file.path);
    reading.invalid_points = content.invalid_points;
    if (content.points.empty()) {
      reading.problem = fmt::format("{}: no valid point ({} with NaN or infinite coordinates)",
                                    file.path.string(), content.invalid_points);
      return reading;
    }
    Scan scan{.points = std::move(content.points),
              .frame = file.frame,
              .stamp_s = file.stamp_s,
              .stamp_fraction = traits_.stamp_fraction,
              .duration_s = file.duration_s,
              .motion_compensated = traits_.motion_compensated};
    recover_rings(scan.points, traits_.sensor);
    recover_sweep_fractions(scan.points, traits_.sensor);
    reading.scan = std::move(scan);
  } catch (const InputError& error) {
    reading.problem = error.what();
  }
  return reading;
}

}  // namespace mlo
