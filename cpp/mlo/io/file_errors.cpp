#include "mlo/io/file_errors.hpp"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>
#include <unistd.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

std::string_view remedy_for(int error) {
  switch (error) {
    case ENOENT:
    case ENOTDIR:
      return "create the folder first";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to";
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or write to another disk";
    case EISDIR:
      return "a folder has this name; choose another";
    default:
      return "check the disk or write somewhere else";
  }
}

ssize_t write_some(int descriptor, std::string_view bytes) {
  ssize_t written = -1;
  do {
    written = ::write(descriptor, bytes.data(), bytes.size());
  } while (written < 0 && errno == EINTR);
  return written;
}

}  // namespace

void fail_to_write(const std::filesystem::path& path, int error) {
  throw InputError(fmt::format("{}: cannot be written: {}; {}", path.string(),
                               std::generic_category().message(error), remedy_for(error)));
}

void write_all(const std::filesystem::path& path, int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = write_some(descriptor, bytes);
    if (written < 0) fail_to_write(path, errno);
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace mlo
