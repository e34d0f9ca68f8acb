#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mlo {

/// One row of a table of the paper: a sequence (and object), and values by method and measure; none: it
/// failed.
struct PaperRow {
  std::string name;
  std::vector<std::vector<std::optional<double>>> values;
};

/// A table of the paper, or what its text says of a figure.
struct PaperTable {
  std::string name;
  std::string caption;
  std::string data;  ///< kitti_odometry, kitti_raw or kitti_tracking
  std::vector<std::string> measures;
  std::vector<std::string> methods;
  std::string note;
  std::vector<PaperRow> rows;
};

struct PaperTables {
  std::string source;
  std::vector<PaperTable> tables;
};

/// @throws InputError naming what is wrong
PaperTables parse_paper_tables(std::string_view yaml);

/// Those of config/paper/tables.yaml, built into the program.
PaperTables paper_tables();

}  // namespace mlo
