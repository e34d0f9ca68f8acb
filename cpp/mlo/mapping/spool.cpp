#include "mlo/mapping/spool.hpp"

#include <cstdlib>
#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "mlo/core/error.hpp"

namespace mlo {
namespace {

[[noreturn]] void fail(const std::string& what) {
  throw InputError(
      fmt::format("{}: {}; the map needs space there: free some, or set TMPDIR to another folder",
                  std::filesystem::temp_directory_path().string(), what));
}

std::FILE* open_nameless() {
  std::string path = (std::filesystem::temp_directory_path() / "mlo_map_XXXXXX").string();
  const int descriptor = mkstemp(path.data());
  if (descriptor < 0) fail("no temporary file can be made");
  unlink(path.c_str());
  std::FILE* file = fdopen(descriptor, "w+b");
  if (file == nullptr) fail("no temporary file can be opened");
  return file;
}

}  // namespace

std::uint64_t Spool::write(std::span<const std::byte> bytes) {
  if (!file_) file_.reset(open_nameless());
  const std::uint64_t place = size_;
  const bool done = fseeko(file_.get(), static_cast<off_t>(place), SEEK_SET) == 0 &&
                    std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size() &&
                    std::fflush(file_.get()) == 0;
  if (!done) fail("writing the temporary file failed");
  size_ += bytes.size();
  return place;
}

void Spool::read(std::uint64_t place, std::span<std::byte> bytes) const {
  if (bytes.empty()) return;
  const bool done = file_ && fseeko(file_.get(), static_cast<off_t>(place), SEEK_SET) == 0 &&
                    std::fread(bytes.data(), 1, bytes.size(), file_.get()) == bytes.size();
  if (!done) fail("reading the temporary file failed");
}

}  // namespace mlo
