#include "mlo/report/run_folder.hpp"

#include <algorithm>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "mlo/core/error.hpp"
#include "mlo/io/object_file.hpp"
#include "mlo/io/point_cloud_file.hpp"
#include "mlo/io/text.hpp"
#include "mlo/io/text_records.hpp"
#include "mlo/io/trajectory_file.hpp"

namespace mlo {
namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::string_view kStageEnding = "_ms";

StageSeries statistics_of(const std::string& name, const ordered_json& json) {
  StageSeries stage;
  stage.name = name;
  stage.mean_ms = json.value("mean_ms", 0.0);
  stage.p50_ms = json.value("p50_ms", 0.0);
  stage.p99_ms = json.value("p99_ms", 0.0);
  stage.max_ms = json.value("max_ms", 0.0);
  return stage;
}

void read_summary(const fs::path& file, RunFolder& run) {
  const ordered_json json = ordered_json::parse(read_file(file), nullptr, false);
  if (!json.is_object()) {
    throw InputError(fmt::format("{}: is no JSON object; run 'mlo run' again", file.string()));
  }
  run.version = json.value("version", "");
  run.boxes_from = json.value("boxes_from", "");
  if (const auto input = json.find("input"); input != json.end() && input->is_object()) {
    run.input_folder = input->value("folder", "");
    run.input_format = input->value("format", "");
    run.input_sequence = input->value("sequence", "");
  }
  for (const auto& [key, value] : json.items()) {
    if (value.is_number()) run.counters.emplace_back(key, value.get<double>());
  }
  if (const auto warnings = json.find("warnings"); warnings != json.end() && warnings->is_array()) {
    for (const ordered_json& warning : *warnings) {
      if (warning.is_string()) run.warnings.push_back(warning.get<std::string>());
    }
  }
  if (const auto times = json.find("times"); times != json.end() && times->is_object()) {
    for (const auto& [name, statistics] : times->items()) {
      if (!statistics.is_object()) continue;
      const StageSeries stage = statistics_of(name, statistics);
      if (name == "scan") {
        run.whole_scan = stage;
      } else {
        run.stages.push_back(stage);
      }
    }
  }
}

// The times of the stages and what went wrong, row by row. A problem is the last cell and may hold commas.
void read_per_scan(const fs::path& file, RunFolder& run) {
  const std::vector<std::string> lines = read_lines(file);
  if (lines.empty()) throw InputError(fmt::format("{}: empty; run 'mlo run' again", file.string()));
  const std::vector<std::string_view> names = split_cells(lines.front());
  for (std::size_t i = 1; i < lines.size(); ++i) {
    const std::vector<std::string_view> cells = split_cells(lines[i]);
    const auto value_of = [&](std::string_view name) {
      const auto at = static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
      const auto number = at < cells.size() ? parse_number(cells[at]) : std::nullopt;
      return number.value_or(std::numeric_limits<double>::quiet_NaN());
    };
    const double frame = value_of("frame");
    run.frames.push_back(frame);
    for (StageSeries& stage : run.stages)
      stage.ms.push_back(value_of(stage.name + std::string(kStageEnding)));
    if (const std::size_t quote = lines[i].find('"'); quote != std::string::npos) {
      const std::string problem = lines[i].substr(quote + 1, lines[i].rfind('"') - quote - 1);
      run.problems.push_back(fmt::format("frame {:g}: {}", frame, problem));
    }
  }
}

fs::path needed(const fs::path& file) {
  if (fs::exists(file)) return file;
  throw InputError(
      fmt::format("{}: not there; a report is made of the folder that 'mlo run --out' wrote", file.string()));
}

}  // namespace

RunFolder read_run_folder(const fs::path& folder) {
  RunFolder run;
  const fs::path clean = folder.lexically_normal();
  run.name = clean.filename().empty() ? clean.parent_path().filename().string() : clean.filename().string();
  read_summary(needed(folder / "run.json"), run);
  read_per_scan(needed(folder / "per_scan.csv"), run);
  run.trajectory = read_trajectory(needed(folder / "trajectory.txt"));
  if (const fs::path map = folder / "static_map.ply"; fs::exists(map)) run.map = read_map(map);
  if (const fs::path objects = folder / "objects.csv"; fs::exists(objects)) {
    run.objects = read_objects_csv(objects);
  }
  return run;
}

}  // namespace mlo
