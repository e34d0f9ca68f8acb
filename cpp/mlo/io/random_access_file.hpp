#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace mlo {

/// A file of which pieces are read. May be used by several threads.
class RandomAccessFile {
 public:
  /// @throws InputError when it is missing or cannot be read
  explicit RandomAccessFile(std::filesystem::path path);
  ~RandomAccessFile();
  RandomAccessFile(const RandomAccessFile&) = delete;
  RandomAccessFile& operator=(const RandomAccessFile&) = delete;

  /// The bytes from an offset on; fewer than `size` where the file ends before.
  /// @throws InputError when the disk fails
  std::string read(std::uint64_t offset, std::size_t size) const;
  std::uint64_t size() const { return size_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace mlo
