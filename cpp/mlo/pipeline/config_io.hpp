#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "mlo/pipeline/config_fields.hpp"

namespace mlo {

/// The configuration as YAML: each value with what it is, its unit and what is allowed as a comment above it.
/// Reading it back gives the same configuration.
std::string to_yaml(const ConfigView& view);

/// Changes the values that the YAML text names; the others stay.
/// @param source  name of the text for messages: the file or preset
/// @throws InputError naming source and line: not YAML, an unknown or repeated key (with the nearest known
/// one),
///         a value of the wrong type or out of range
void apply_yaml(const ConfigView& view, const std::string& text, std::string_view source);

/// The same for a file.
/// @throws InputError also when the file cannot be read
void apply_yaml_file(const ConfigView& view, const std::filesystem::path& file);

/// Changes one value: "sensor.max_range_m=80"; lists as "[1, 2, 3]".
/// @throws InputError as apply_yaml
void apply_setting(const ConfigView& view, std::string_view setting);

/// Values out of range or not a number, and broken rules between values; one sentence each, empty when all is
/// well.
std::vector<std::string> find_problems(const ConfigView& view);

/// The entry nearest to `word` by edit distance (insertion, deletion, substitution, swap of neighbours), or
/// empty when none is near enough to be a slip. Of two dotted keys the last parts may be compared alone.
std::string nearest(std::string_view word, const std::vector<std::string>& entries);

}  // namespace mlo
