#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mlo/reproduction/find_data.hpp"
#include "mlo/reproduction/paper_tables.hpp"

namespace mlo {

/// How the pipeline is run for a table.
struct Variant {
  std::string name;   ///< of the folders of its runs
  std::string title;  ///< for the table
  std::vector<std::string> presets;
  std::vector<std::string> settings;  ///< "key=value"
};

/// Those whose numbers stand beside the paper's: for Tables I and II the paper's method on the camera's view,
/// for Table II also without the consistency check (MLO-gc), and this program's defaults on full scans. None
/// for tables that need no runs.
std::vector<Variant> variants_of(const PaperTable& table);

/// A row of a table with the numbers of this program.
struct ReproducedRow {
  PaperRow paper;
  bool has_data = false;  ///< false: the data is missing
  /// By variant (Table III and Fig. 7: one), then by measure; none: it could not be computed.
  std::vector<std::vector<std::optional<double>>> here;
  std::string note;  ///< how many scans there were, or why there is nothing
};

struct ReproducedTable {
  PaperTable paper;
  std::vector<std::string> titles;  ///< of the columns `here`
  std::vector<ReproducedRow> rows;
  std::vector<std::string> missing;  ///< names of rows whose data is not there
};

struct ReproduceOptions {
  std::filesystem::path out;                              ///< one folder per run below it
  std::size_t last_frame = static_cast<std::size_t>(-1);  ///< shorter runs, to try things out
};

/// What is going on, for a display.
struct ReproduceProgress {
  std::function<void(const std::string& run)> on_run;  ///< a run begins or is taken from disk
  std::function<void(std::size_t done, std::size_t total)> on_scan;
  std::function<bool()> should_stop;
};

/// Computes one table. Runs whose folder holds a finished run.json are not repeated.
/// @throws InputError when data that is there cannot be used
ReproducedTable reproduce_table(const PaperTable& table, const KittiData& data,
                                const ReproduceOptions& options, const ReproduceProgress& progress);

/// The table as text, the paper's values beside those here.
std::string to_text(const ReproducedTable& table);

}  // namespace mlo
