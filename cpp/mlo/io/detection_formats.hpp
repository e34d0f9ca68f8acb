#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mlo/io/dataset.hpp"
#include "mlo/io/detections.hpp"

// Parsers of single detection files. Internal to io.
namespace mlo {

/// One row of a file. The confidence is not set yet: it depends on all scores.
struct ParsedDetection {
  std::optional<std::size_t> frame;  ///< nothing where the row has a stamp instead
  double stamp_s = 0.0;
  DetectionRecord record;
};

/// A place in a file, for messages.
struct Place {
  const std::filesystem::path& path;
  std::size_t line = 0;
  [[noreturn]] void fail(std::string_view problem, std::string_view remedy) const;
};

/// @throws InputError if a side is not positive or anything is not finite
void check_box(const Box3d& box, const Place& place);
/// @throws InputError listing the classes that are known
ObjectClass parse_class(std::string_view name, const Place& place);
double parse_finite(std::string_view text, std::string_view what, const Place& place);

/// True if the text has one of KITTI's object formats, whose rows have no frame: a file is one frame.
bool is_file_per_frame(std::string_view text);

/// KITTI's formats and their relatives.
/// @param file_frame  frame of the rows of formats that do not have it
std::vector<ParsedDetection> parse_kitti_detections(const std::filesystem::path& path, std::string_view text,
                                                    std::optional<std::size_t> file_frame,
                                                    const Calibration& calibration);
/// Our own formats (docs/detections.md).
std::vector<ParsedDetection> parse_csv_detections(const std::filesystem::path& path, std::string_view text);
std::vector<ParsedDetection> parse_json_detections(const std::filesystem::path& path, std::string_view text);

}  // namespace mlo
