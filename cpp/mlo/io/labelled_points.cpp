#include "mlo/io/labelled_points.hpp"

#include <bit>
#include <cmath>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/cloud_rows.hpp"
#include "mlo/io/text.hpp"

namespace mlo {
namespace {

static_assert(std::endian::native == std::endian::little, "labels are copied as they are stored");

constexpr std::uint32_t kClassBits = 0xFFFF;
constexpr std::uint32_t kOutlier = 1;
constexpr std::uint32_t kFirstMovable = 10;  // car
constexpr std::uint32_t kLastMovable = 32;   // motorcyclist
constexpr std::uint32_t kFirstMoving = 252;
constexpr std::uint32_t kLastMoving = 259;

Mobility mobility_of_row(const RoleValues& row, bool has_label, Movable movable) {
  const double value = row[index_of(has_label ? Role::label : Role::intensity)];
  if (!(value >= 0.0 && value <= 4294967295.0)) return Mobility::unknown;
  if (has_label) return mobility_of(static_cast<std::uint32_t>(value), movable);
  return value > 0.5 ? Mobility::moving : Mobility::at_rest;
}

}  // namespace

Mobility mobility_of(std::uint32_t semantic_label, Movable movable) {
  const std::uint32_t semantic_class = semantic_label & kClassBits;
  if (semantic_class <= kOutlier) return Mobility::unknown;
  const bool is_movable = semantic_class >= kFirstMovable && semantic_class <= kLastMovable;
  if (is_movable && movable == Movable::is_left_out) return Mobility::unknown;
  const bool moves = semantic_class >= kFirstMoving && semantic_class <= kLastMoving;
  return moves ? Mobility::moving : Mobility::at_rest;
}

std::vector<std::uint32_t> read_semantic_labels(const std::filesystem::path& file) {
  const std::string bytes = read_file(file);
  if (bytes.size() % sizeof(std::uint32_t) != 0) {
    throw InputError(
        fmt::format("{}: {} bytes are not a whole number of labels of 4 bytes; the file may be cut off",
                    file.string(), bytes.size()));
  }
  std::vector<std::uint32_t> labels(bytes.size() / sizeof(std::uint32_t));
  if (!labels.empty()) std::memcpy(labels.data(), bytes.data(), bytes.size());
  return labels;
}

std::vector<LabelledPoint> read_labelled_cloud(const std::filesystem::path& file, Movable movable) {
  std::vector<LabelledPoint> points;
  bool has_label = false;
  const auto begin = [&](const CloudFields& fields, std::size_t rows) {
    has_label = fields.has(Role::label);
    if (!has_label && !fields.has(Role::intensity)) {
      throw InputError(fmt::format(
          "{}: has neither a field label (SemanticKITTI's classes) nor intensity (1 moving, 0 not), so that "
          "nothing tells what moves; see docs/evaluation.md",
          file.string()));
    }
    points.reserve(rows);
  };
  const auto add = [&](const RoleValues& row) {
    const LabelledPoint point{position_of(row), mobility_of_row(row, has_label, movable)};
    if (point.p_map.allFinite()) points.push_back(point);
  };
  read_cloud_rows(file, {begin, add});
  return points;
}

}  // namespace mlo
