#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <span>

namespace mlo {

/// Bytes that wait on disk, in a nameless file in the system's folder for temporary files (TMPDIR): gone with
/// the process. The file is made when first needed. What was written stays where it is.
class Spool {
 public:
  /// @return where the bytes are
  /// @throws InputError when the folder cannot be written or is full
  std::uint64_t write(std::span<const std::byte> bytes);
  /// @throws InputError when the file cannot be read
  void read(std::uint64_t place, std::span<std::byte> bytes) const;

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
  std::uint64_t size_ = 0;
};

}  // namespace mlo
