#pragma once

#include <filesystem>
#include <vector>

#include "mlo/io/dataset.hpp"

namespace mlo {

/// One scan of a sequence on disk.
struct ScanFile {
  std::filesystem::path path;  ///< a file that is not there counts as a missing scan
  std::size_t frame = 0;
  double stamp_s = 0.0;
  double duration_s = 0.1;
};

/// What all scans of a sequence have in common.
struct ScanFileTraits {
  SensorConfig sensor;  ///< to recover rings and sweep fractions that the files lack
  double stamp_fraction = 0.5;
  bool motion_compensated = false;
};

/// Scans in separate files, in the order given.
class ScanFiles : public ScanSource {
 public:
  ScanFiles(std::vector<ScanFile> files, ScanFileTraits traits);

  std::size_t size() const override { return files_.size(); }
  std::size_t frame(std::size_t index) const override { return files_.at(index).frame; }
  ScanReading read(std::size_t index) const override;

 private:
  std::vector<ScanFile> files_;
  ScanFileTraits traits_;
};

}  // namespace mlo
