#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace mlo {

/// Keeps the state of a run, whole or not at all.
/// @param owner  what the state belongs to; it is of no use to anything else
/// @throws InputError when the file cannot be written; an older one then stays
void write_checkpoint(const std::filesystem::path& file, const std::string& owner, const std::string& state);

/// The state again; nothing where there is no such file.
/// @throws InputError when it is damaged, or belongs to something else (with the first line that differs)
std::optional<std::string> read_checkpoint(const std::filesystem::path& file, const std::string& owner);

}  // namespace mlo
