#include "mlo/io/append_file.hpp"

#include <cerrno>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "mlo/io/file_errors.hpp"

namespace mlo {

AppendFile::AppendFile(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kReadableByAll);
  if (descriptor_ < 0) fail_to_write(path_, errno);
}

AppendFile::AppendFile(std::filesystem::path path, std::uint64_t size) : path_(std::move(path)), size_(size) {
  descriptor_ = ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
  if (descriptor_ < 0) fail_to_write(path_, errno);
  const auto end = static_cast<off_t>(size);
  const off_t present = ::lseek(descriptor_, 0, SEEK_END);
  const bool done =
      present >= end && ::ftruncate(descriptor_, end) == 0 && ::lseek(descriptor_, 0, SEEK_END) == end;
  if (done) return;
  const int error = present >= 0 && present < end ? ENODATA : errno;
  ::close(descriptor_);
  fail_to_write(path_, error);
}

AppendFile::~AppendFile() {
  ::close(descriptor_);
}

void AppendFile::append(std::string_view bytes) {
  write_all(path_, descriptor_, bytes);
  size_ += bytes.size();
}

}  // namespace mlo
