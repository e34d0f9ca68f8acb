#include "mlo/io/object_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "mlo/core/error.hpp"
#include "mlo/io/atomic_file.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"

namespace mlo {
namespace {

// Files with few digits are off by 1e-3; anything beyond this is not a rotation at all.
constexpr double kUnitTolerance = 1e-2;
constexpr std::array<std::string_view, 3> kSize{"length_m", "width_m", "height_m"};

// One row, whose cells are asked for by the names of the header.
class Row {
 public:
  Row(const std::vector<std::string_view>& names, const std::vector<std::string_view>& cells,
      std::string where)
      : names_(names), cells_(cells), where_(std::move(where)) {
    if (cells.size() == names.size()) return;
    fail(fmt::format("{} values under {} columns", cells.size(), names.size()));
  }

  [[noreturn]] void fail(const std::string& problem) const {
    throw InputError(fmt::format("{}: {}; docs/evaluation.md says what objects.csv holds", where_, problem));
  }
  /// Nothing where there is no such column, or no value in it.
  std::optional<std::string_view> text(std::string_view name) const {
    const auto found = std::find(names_.begin(), names_.end(), name);
    if (found == names_.end()) return std::nullopt;
    const std::string_view cell = cells_[static_cast<std::size_t>(found - names_.begin())];
    return cell.empty() ? std::nullopt : std::optional(cell);
  }
  std::optional<double> number(std::string_view name) const {
    const auto cell = text(name);
    if (!cell) return std::nullopt;
    const std::optional<double> value = parse_number(*cell);
    if (!value || !std::isfinite(*value)) fail(fmt::format("{}: '{}' is not a finite number", name, *cell));
    return value;
  }
  double needed_number(std::string_view name) const {
    const std::optional<double> value = number(name);
    if (!value) fail(fmt::format("there is no {}", name));
    return *value;
  }
  std::size_t needed_count(std::string_view name) const {
    const double value = needed_number(name);
    if (value < 0.0 || value != std::floor(value)) fail(fmt::format("{}: no whole number from 0", name));
    return static_cast<std::size_t>(value);
  }

 private:
  const std::vector<std::string_view>& names_;
  const std::vector<std::string_view>& cells_;
  std::string where_;
};

SE3 parse_pose(const Row& row) {
  const Eigen::Quaterniond rotation(row.needed_number("qw"), row.needed_number("qx"), row.needed_number("qy"),
                                    row.needed_number("qz"));
  if (!(std::abs(rotation.norm() - 1.0) < kUnitTolerance)) row.fail("qx, qy, qz, qw are no rotation");
  return {rotation, {row.needed_number("x_m"), row.needed_number("y_m"), row.needed_number("z_m")}};
}

ObjectPose parse_row(const Row& row) {
  ObjectPose object;
  object.frame = row.needed_count("frame");
  object.stamp_s = row.number("stamp_s");
  object.id = static_cast<long>(row.needed_count("id"));
  if (const auto type = row.text("class")) object.type = to_lower(*type);
  if (object.type.empty()) row.fail("there is no class");
  object.state = row.text("state").value_or("");
  object.T_map_object = parse_pose(row);
  for (std::size_t i = 0; i < kSize.size(); ++i) {
    object.size_lwh_m(static_cast<Eigen::Index>(i)) = row.number(kSize[i]).value_or(0.0);
  }
  if (row.text("points")) object.points = row.needed_count("points");
  object.visible_share = row.number("visible_share");
  return object;
}

void require_unique(const std::vector<ObjectPose>& objects, const std::filesystem::path& file) {
  const auto twice = std::adjacent_find(objects.begin(), objects.end(), [](const auto& a, const auto& b) {
    return a.frame == b.frame && a.id == b.id;
  });
  if (twice == objects.end()) return;
  throw InputError(fmt::format("{}: object {} stands twice in frame {}; an id may stand only once in a frame",
                               file.string(), twice->id, twice->frame));
}

}  // namespace

std::vector<ObjectPose> read_objects_csv(const std::filesystem::path& file) {
  const std::vector<std::string> lines = read_lines(file);
  if (lines.empty()) {
    throw InputError(fmt::format("{}: empty; a header line that names the columns is needed", file.string()));
  }
  const std::vector<std::string_view> names = split_cells(lines.front());
  std::vector<ObjectPose> objects;
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string_view> cells = split_cells(lines[i]);
    objects.push_back(parse_row(Row(names, cells, fmt::format("{}:{}", file.string(), i + 1))));
  }
  std::stable_sort(objects.begin(), objects.end(), [](const ObjectPose& a, const ObjectPose& b) {
    return std::tie(a.frame, a.id) < std::tie(b.frame, b.id);
  });
  require_unique(objects, file);
  return objects;
}

std::string objects_csv_header() {
  return "frame,stamp_s,id,class,state,x_m,y_m,z_m,qx,qy,qz,qw,length_m,width_m,height_m,points";
}

std::string objects_csv_row(const ObjectPose& object) {
  const Eigen::Vector3d& p = object.T_map_object.translation();
  const Eigen::Quaterniond& q = object.T_map_object.rotation();
  return fmt::format(
      "{},{},{},{},{},{:.5f},{:.5f},{:.5f},{:.8f},{:.8f},{:.8f},{:.8f},{:.4f},{:.4f},{:.4f},{}", object.frame,
      object.stamp_s ? fmt::format("{:.6f}", *object.stamp_s) : "", object.id, object.type, object.state,
      p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w(), object.size_lwh_m.x(), object.size_lwh_m.y(),
      object.size_lwh_m.z(), object.points ? fmt::format("{}", *object.points) : "");
}

void write_objects_csv(const std::filesystem::path& file, std::span<const ObjectPose> objects) {
  std::string content = objects_csv_header() + "\n";
  for (const ObjectPose& object : objects) content += objects_csv_row(object) + "\n";
  write_file_atomically(file, content);
}

}  // namespace mlo
