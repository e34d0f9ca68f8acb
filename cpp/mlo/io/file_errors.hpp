#pragma once

#include <filesystem>
#include <string_view>

#include <sys/types.h>

// What the classes that write files have in common. Internal to io.
namespace mlo {

/// Permissions of new files; the process's umask takes away what it wants.
constexpr mode_t kReadableByAll = 0666;

/// @param error  errno
/// @throws InputError with the file, what the system says and a remedy; always
[[noreturn]] void fail_to_write(const std::filesystem::path& path, int error);

/// All bytes, in as many calls as it takes. @throws InputError as above
void write_all(const std::filesystem::path& path, int descriptor, std::string_view bytes);

}  // namespace mlo
