#include "mlo/reproduction/paper_tables.hpp"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "mlo/core/error.hpp"
#include "mlo/reproduction/embedded_tables.hpp"

namespace mlo {
namespace {

constexpr const char* kFailed = "fail";

[[noreturn]] void fail(const std::string& table, const std::string& row, const std::string& problem) {
  throw InputError(fmt::format("tables of the paper: {}, row {}: {}", table, row, problem));
}

PaperRow parse_row(const PaperTable& table, const std::string& name, const YAML::Node& node) {
  PaperRow row{name, {}};
  if (node.size() != table.methods.size()) {
    fail(table.name, name, fmt::format("{} entries for {} methods", node.size(), table.methods.size()));
  }
  for (const YAML::Node& method : node) {
    if (method.size() != table.measures.size()) {
      fail(table.name, name, fmt::format("{} values for {} measures", method.size(), table.measures.size()));
    }
    std::vector<std::optional<double>> values;
    for (const YAML::Node& value : method) {
      const bool failed = value.as<std::string>() == kFailed;
      values.push_back(failed ? std::nullopt : std::optional(value.as<double>()));
    }
    row.values.push_back(std::move(values));
  }
  return row;
}

PaperTable parse_table(const YAML::Node& node) {
  PaperTable table{.name = node["name"].as<std::string>(),
                   .caption = node["caption"].as<std::string>(),
                   .data = node["data"].as<std::string>(),
                   .measures = node["measures"].as<std::vector<std::string>>(),
                   .methods = node["methods"].as<std::vector<std::string>>(),
                   .note = node["note"] ? node["note"].as<std::string>() : "",
                   .rows = {}};
  for (const auto& row : node["rows"])
    table.rows.push_back(parse_row(table, row.first.as<std::string>(), row.second));
  return table;
}

}  // namespace

PaperTables parse_paper_tables(std::string_view yaml) {
  try {
    const YAML::Node root = YAML::Load(std::string(yaml));
    PaperTables tables{.source = root["source"].as<std::string>(), .tables = {}};
    for (const YAML::Node& table : root["tables"]) tables.tables.push_back(parse_table(table));
    return tables;
  } catch (const YAML::Exception& error) {
    throw InputError(fmt::format("tables of the paper: {}", error.what()));
  }
}

PaperTables paper_tables() {
  return parse_paper_tables(kEmbeddedTables);
}

}  // namespace mlo
