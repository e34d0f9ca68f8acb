#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace mlo {

/// Writes a file whole or not at all: the content goes to a temporary file beside it, which takes the final
/// name in commit(). A reader never sees half a file, and an older file survives a full disk or a crash.
/// Without commit() the temporary file is removed.
class AtomicFile {
 public:
  /// @throws InputError when the folder is missing or not writable
  explicit AtomicFile(std::filesystem::path path);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends bytes. @throws InputError when they can not be written (disk full, quota)
  void write(std::string_view bytes);
  /// Puts everything on disk and gives the file its name. Call once, last. @throws InputError as write()
  void commit();

 private:
  void flush();

  std::filesystem::path path_;
  std::filesystem::path temporary_;
  std::string buffer_;
  int descriptor_ = -1;
};

/// The same for content that is at hand as a whole.
/// @throws InputError when the file can not be written
void write_file_atomically(const std::filesystem::path& path, std::string_view content);

}  // namespace mlo
