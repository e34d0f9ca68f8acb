#include "mlo/pipeline/config_io.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <utility>

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

constexpr std::size_t kLineLength = 110;

/// Breaks text at spaces; every line but the first begins with `prefix`.
std::string wrap(const std::string& text, std::size_t first_column, const std::string& prefix) {
  std::istringstream words(text);
  std::string result;
  std::string word;
  std::size_t column = first_column;
  while (words >> word) {
    const bool first_of_line = result.empty();
    if (!first_of_line && column + 1 + word.size() > kLineLength) {
      result += "\n" + prefix + word;
      column = prefix.size() + word.size();
    } else {
      result += first_of_line ? word : " " + word;
      column += word.size() + (first_of_line ? 0 : 1);
    }
  }
  return result;
}

std::string comment(const std::string& doc, const std::string& allowed, const std::string& indent) {
  const std::string text = allowed.empty() ? doc : fmt::format("{} ({})", doc, allowed);
  const std::string prefix = indent + "# ";
  return prefix + wrap(text, prefix.size(), prefix) + "\n";
}

std::string parent_of(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(0, dot);
}

std::string leaf_of(std::string_view path) {
  const std::size_t dot = path.rfind('.');
  return std::string(dot == std::string_view::npos ? path : path.substr(dot + 1));
}

std::string indent_of(const std::string& path) {
  return std::string(2 * static_cast<std::size_t>(std::count(path.begin(), path.end(), '.')), ' ');
}

const ConfigGroup* find_group(const ConfigView& view, const std::string& path) {
  const auto found = std::find_if(view.groups.begin(), view.groups.end(),
                                  [&](const ConfigGroup& group) { return group.path == path; });
  return found == view.groups.end() ? nullptr : &*found;
}

const ConfigField* find_field(const ConfigView& view, const std::string& path) {
  const auto found = std::find_if(view.fields.begin(), view.fields.end(),
                                  [&](const ConfigField& field) { return field.path == path; });
  return found == view.fields.end() ? nullptr : &*found;
}

/// The headings of all groups around `path` that are not open yet, the outermost first.
std::string headings(const ConfigView& view, const std::string& group_path, std::set<std::string>& opened) {
  if (group_path.empty() || opened.contains(group_path)) return {};
  const std::string gap = opened.empty() ? "" : "\n";
  const std::string outer = headings(view, parent_of(group_path), opened);
  opened.insert(group_path);
  const std::string indent = indent_of(group_path);
  const ConfigGroup* const group = find_group(view, group_path);
  return outer + gap + comment(group->doc, "", indent) + indent + leaf_of(group_path) + ":\n";
}

std::vector<std::string> all_keys(const ConfigView& view) {
  std::vector<std::string> keys;
  for (const ConfigField& field : view.fields) keys.push_back(field.path);
  for (const ConfigGroup& group : view.groups) keys.push_back(group.path);
  return keys;
}

InputError unknown_key(const ConfigView& view, const std::string& path, const std::string& where) {
  const std::string suggestion = nearest(path, all_keys(view));
  return InputError(fmt::format(
      "{}: unknown key '{}'; {}", where, path,
      suggestion.empty() ? "'mlo config' lists all keys" : fmt::format("did you mean '{}'?", suggestion)));
}

void assign(const ConfigField& field, const std::vector<std::string>& words, bool is_list,
            const std::string& where) {
  if (const auto problem = field.assign(words, is_list)) {
    throw InputError(fmt::format("{}: {}: {}", where, field.path, *problem));
  }
}

void assign_node(const ConfigField& field, const YAML::Node& node, const std::string& where) {
  if (node.IsScalar()) return assign(field, {node.Scalar()}, false, where);
  if (!node.IsSequence()) {
    throw InputError(
        fmt::format("{}: {}: needs a value{}", where, field.path, node.IsMap() ? ", not keys" : ""));
  }
  std::vector<std::string> words;
  for (const YAML::Node& element : node) {
    if (!element.IsScalar()) {
      throw InputError(fmt::format("{}: {}: needs a list of numbers", where, field.path));
    }
    words.push_back(element.Scalar());
  }
  assign(field, words, true, where);
}

std::string place(std::string_view source, const YAML::Mark& mark) {
  return mark.is_null() ? std::string(source) : fmt::format("{}:{}", source, mark.line + 1);
}

/// Applies a mapping whose keys live below `group_path`. An empty node changes nothing.
void apply_map(const ConfigView& view, const YAML::Node& node, const std::string& group_path,
               std::string_view source) {
  if (!node.IsDefined() || node.IsNull()) return;
  if (!node.IsMap()) {
    throw InputError(fmt::format("{}: {} must hold 'key: value' lines", place(source, node.Mark()),
                                 group_path.empty() ? "a configuration" : "'" + group_path + "'"));
  }
  std::set<std::string> seen;
  for (const auto& entry : node) {
    const std::string where = place(source, entry.first.Mark());
    if (!entry.first.IsScalar()) throw InputError(where + ": a key must be a word");
    const std::string name = entry.first.Scalar();
    const std::string path = group_path.empty() ? name : group_path + "." + name;
    if (!seen.insert(path).second) throw InputError(fmt::format("{}: '{}' is given twice", where, path));
    if (find_group(view, path) != nullptr) {
      apply_map(view, entry.second, path, source);
    } else if (const ConfigField* const field = find_field(view, path)) {
      assign_node(*field, entry.second, where);
    } else {
      throw unknown_key(view, path, where);
    }
  }
}

/// Edits (insertion, deletion, substitution, swap of neighbours) that turn one word into the other.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::vector<std::size_t>> cost(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
  for (std::size_t i = 0; i <= a.size(); ++i) {
    for (std::size_t j = 0; j <= b.size(); ++j) {
      if (i == 0 || j == 0) {
        cost[i][j] = i + j;
        continue;
      }
      const std::size_t substitution = cost[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      cost[i][j] = std::min({cost[i - 1][j] + 1, cost[i][j - 1] + 1, substitution});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) cost[i][j] = std::min(cost[i][j], cost[i - 2][j - 2] + 1);
    }
  }
  return cost[a.size()][b.size()];
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& entries) {
  const std::string leaf = leaf_of(word);
  const std::size_t longest = std::max<std::size_t>(2, leaf.size() / 3);
  std::string best;
  std::size_t best_distance = longest + 1;
  for (const std::string& entry : entries) {
    // A good last part in the wrong group is one slip.
    const std::size_t leaf_distance = edit_distance(leaf, leaf_of(entry)) + 1;
    const std::size_t distance = std::min(edit_distance(word, entry), leaf_distance);
    if (distance < best_distance) {
      best = entry;
      best_distance = distance;
    }
  }
  return best;
}

std::string to_yaml(const ConfigView& view) {
  std::string text;
  std::set<std::string> opened;
  for (const ConfigField& field : view.fields) {
    text += headings(view, parent_of(field.path), opened);
    const std::string indent = indent_of(field.path);
    const std::string line = fmt::format("{}{}: ", indent, leaf_of(field.path));
    const bool is_list = std::holds_alternative<NumberListSlot>(field.slot);
    const std::string value =
        is_list ? wrap(field.value_text(), line.size(), indent + "    ") : field.value_text();
    text += comment(field.doc, field.allowed_text(), indent) + line + value + "\n";
  }
  return text;
}

void apply_yaml(const ConfigView& view, const std::string& text, std::string_view source) {
  std::vector<YAML::Node> documents;
  try {
    documents = YAML::LoadAll(text);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}: not valid YAML: {}", place(source, e.mark), e.msg));
  }
  if (documents.size() > 1) {
    throw InputError(
        fmt::format("{}: holds {} YAML documents; give one file each", source, documents.size()));
  }
  if (!documents.empty()) apply_map(view, documents.front(), "", source);
}

void apply_yaml_file(const ConfigView& view, const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream || std::filesystem::is_directory(file)) {
    throw InputError(fmt::format("{}: cannot be read; give an existing YAML file", file.string()));
  }
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  apply_yaml(view, text, file.string());
}

void apply_setting(const ConfigView& view, std::string_view setting) {
  const std::string where = fmt::format("--set {}", setting);
  const std::size_t equals = setting.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    throw InputError(where + ": write key=value, as in sensor.max_range_m=80");
  }
  const std::string path(setting.substr(0, equals));
  const std::string value(setting.substr(equals + 1));
  if (find_group(view, path) != nullptr) {
    throw InputError(fmt::format("{}: '{}' is a group; set one of its values", where, path));
  }
  const ConfigField* const field = find_field(view, path);
  if (field == nullptr) throw unknown_key(view, path, where);
  if (!std::holds_alternative<NumberListSlot>(field->slot)) return assign(*field, {value}, false, where);
  try {
    assign_node(*field, YAML::Load(value), where);
  } catch (const YAML::Exception& e) {
    throw InputError(fmt::format("{}: not a list: {}", where, e.msg));
  }
}

std::vector<std::string> find_problems(const ConfigView& view) {
  std::vector<std::string> problems;
  for (const ConfigField& field : view.fields) {
    if (const auto problem = field.find_problem()) {
      problems.push_back(fmt::format("{}: {}", field.path, *problem));
    }
  }
  for (const ConfigRule& rule : view.rules) {
    for (const std::string& problem : rule.find_problems()) {
      problems.push_back(rule.path.empty() ? problem : fmt::format("{}: {}", rule.path, problem));
    }
  }
  return problems;
}

}  // namespace mlo
