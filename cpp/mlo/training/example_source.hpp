#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/training/example.hpp"

namespace mlo {

struct ExampleOptions {
  OpenOptions open = {};
  std::size_t min_points = 5;  ///< boxes with fewer returns are not demanded
};

/// One attempt to read an example: the example, or why there is none.
struct ExampleReading {
  std::optional<TrainingExample> example;
  std::string problem;  ///< file, what is wrong and the remedy; empty when there is an example
};

/// The labelled scans of a data set, in the order of their frames. Read by index, from any thread.
class ExampleSource {
 public:
  virtual ~ExampleSource() = default;
  virtual std::size_t size() const = 0;
  /// Where it is from, also when it cannot be read.
  virtual std::string name(std::size_t index) const = 0;
  /// Points as a detector gets them: within the sensor's range limits, elevations corrected.
  /// @throws InputError if the labels of a scan cannot be understood
  virtual ExampleReading read(std::size_t index) const = 0;
};

/// Opens a data set that has labels. What is looked for, in turn:
///  - exact truth of a simulation (truth/objects.csv and truth/poses_stamp.txt): labelled all round;
///  - labels of the KITTI tracking benchmark (label_02/NNNN.txt) or tracklets of a KITTI raw drive: labelled
///    where camera 2 looks, from the first labelled frame to the last;
///  - the KITTI object benchmark (velodyne, label_2 and calib with a file for each scan): the same, each scan
///    by itself.
/// @throws InputError if there are none, or they cannot be understood
std::unique_ptr<ExampleSource> open_examples(const std::filesystem::path& folder,
                                             const ExampleOptions& options = {});

}  // namespace mlo
