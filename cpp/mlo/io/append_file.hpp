#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace mlo {

/// A file that grows. What append() was given is with the system when it returns: a process that is killed
/// leaves it in the file, and at most a piece of the next.
class AppendFile {
 public:
  /// A new file; one of the same name is replaced.
  /// @throws InputError when the folder is missing or not writable
  explicit AppendFile(std::filesystem::path path);
  /// Goes on after the first `size` bytes of a file; what it has beyond them is cut off.
  /// @throws InputError when there is no such file, it is shorter, or it cannot be written
  AppendFile(std::filesystem::path path, std::uint64_t size);
  ~AppendFile();
  AppendFile(const AppendFile&) = delete;
  AppendFile& operator=(const AppendFile&) = delete;

  /// @throws InputError when the bytes cannot be written (disk full, quota); those before are kept
  void append(std::string_view bytes);
  std::uint64_t size() const { return size_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace mlo
