#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "mlo/io/scalar.hpp"

// What PCD and PLY have in common: rows of named numbers, as text or bytes. Internal to io.
namespace mlo {

/// What a column means to us. Columns of other names are read over.
enum class Role { x, y, z, intensity, time, ring, label };
constexpr std::size_t kNumRoles = 7;
using RoleValues = std::array<double, kNumRoles>;
constexpr RoleValues kAbsent{0.0, 0.0,  0.0, 0.0,
                             0.0, -1.0, 0.0};  ///< what a file without a role gives for it
constexpr std::size_t index_of(Role role) {
  return static_cast<std::size_t>(role);
}

/// One column of the rows of a file.
struct Column {
  std::string name;
  ScalarType type = ScalarType::float32;
  std::size_t count = 1;                    ///< numbers in it
  std::optional<ScalarType> list_length{};  ///< PLY lists: their count is stored in front of them
  std::optional<Role> role{};
};

/// Which columns were found.
struct CloudFields {
  std::array<bool, kNumRoles> present{};
  bool integer_time = false;
  bool has(Role role) const { return present[index_of(role)]; }
};

/// Receives the points of a file.
struct RowSink {
  /// Called once, before the first point, with what the points have and how many there are.
  std::function<void(const CloudFields&, std::size_t)> begin;
  std::function<void(const RoleValues&)> add;
};

/// Gives every column its role by its name; where several fit (intensity and reflectivity) the usual one
/// wins. Names are taken without case and without CloudCompare's prefix "scalar_".
/// @throws InputError when there is no x, y or z
CloudFields assign_roles(std::vector<Column>& columns, const std::filesystem::path& path);

/// Walks over rows of bytes from an offset.
class BinaryCursor {
 public:
  BinaryCursor(const std::filesystem::path& path, std::string_view bytes, std::size_t offset,
               std::endian order)
      : path_(path), bytes_(bytes), offset_(offset), order_(order) {}
  void begin_row() {}
  void end_row() {}
  /// @throws InputError, as all below, when the file ends before
  double next(ScalarType type);
  std::size_t next_length(ScalarType type);
  void skip(ScalarType type, std::size_t count);
  /// Fails at once when what is left can not hold so many rows.
  void expect_rows(std::size_t rows, const std::vector<Column>& columns) const;

 private:
  const char* take(std::size_t size);

  const std::filesystem::path& path_;
  std::string_view bytes_;
  std::size_t offset_;
  std::endian order_;
};

/// The same over lines of text; empty lines are skipped.
class TextCursor {
 public:
  /// @param line_number  of the line before `offset`, counted from 1
  TextCursor(const std::filesystem::path& path, std::string_view bytes, std::size_t offset,
             std::size_t line_number)
      : path_(path), bytes_(bytes), offset_(offset), line_number_(line_number) {}
  void begin_row();
  void end_row() const;
  double next(ScalarType type);
  std::size_t next_length(ScalarType type);
  void skip(ScalarType type, std::size_t count);
  void expect_rows(std::size_t rows, const std::vector<Column>& columns) const;

 private:
  std::string_view next_word();

  const std::filesystem::path& path_;
  std::string_view bytes_;
  std::size_t offset_;
  std::size_t line_number_;
  std::vector<std::string_view> words_;  ///< of this line
  std::size_t next_word_ = 0;
};

/// Calls add with every row.
template <class Cursor, class Add>
void read_rows(Cursor& cursor, const std::vector<Column>& columns, std::size_t rows, const Add& add) {
  RoleValues values = kAbsent;
  for (std::size_t i = 0; i < rows; ++i) {
    cursor.begin_row();
    for (const Column& column : columns) {
      if (column.role) {
        values[index_of(*column.role)] = cursor.next(column.type);
      } else {
        cursor.skip(column.type, column.list_length ? cursor.next_length(*column.list_length) : column.count);
      }
    }
    cursor.end_row();
    add(values);
  }
}

/// The points themselves: finds out what they have, then hands all to the sink.
template <class Cursor>
void read_points(Cursor& cursor, std::vector<Column> columns, std::size_t rows, const RowSink& sink,
                 const std::filesystem::path& path) {
  const CloudFields fields = assign_roles(columns, path);
  cursor.expect_rows(rows, columns);
  sink.begin(fields, rows);
  read_rows(cursor, columns, rows, sink.add);
}

/// Reading of the two formats; every point goes to the sink. @throws InputError with file, line or byte
void read_pcd_rows(const std::filesystem::path& path, std::string_view bytes, const RowSink& sink);
void read_ply_rows(const std::filesystem::path& path, std::string_view bytes, const RowSink& sink);
/// The one that the file's name asks for.
void read_cloud_rows(const std::filesystem::path& path, const RowSink& sink);

/// x, y, z of a row.
Eigen::Vector3f position_of(const RoleValues& row);

}  // namespace mlo
