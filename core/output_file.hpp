#pragma once
/// \file Output file that appears completely or not at all, and reading a whole file at once.

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace supple {

/// Whether this is a pipe, a terminal, /dev/null, a descriptor of this process (/dev/stderr, even where that goes to a
/// file) and the like: what takes bytes and must not be replaced.
bool is_stream(const std::filesystem::path& path);

/// Collects output under a temporary name in the target's folder; commit() brings it to the disk and then
/// gives it the target's name in one step. Until then, and after any failure, the old file stands as it was
/// and nothing partial remains. Symbolic links are followed. Streams are written to at once.
/// \throws InputError naming the file and the system's reason, from every member but the destructor.
class OutputFile {
 public:
  explicit OutputFile(const std::filesystem::path& path);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  void write(std::span<const std::byte> bytes);
  void write(std::string_view text) { write(std::as_bytes(std::span(text))); }
  void commit();

 private:
  [[noreturn]] void fail(const char* action) const;

  std::filesystem::path path_, temporary_;
  int descriptor_ = -1;
};

/// Removes what OutputFiles have not committed, and lets none of them go on: the last act of a process that is to end at
/// once.
void abandon_output_files();

/// OutputFile for content that is there at once.
void write_file(const std::filesystem::path& path, std::string_view content);

/// All bytes of a file. \throws InputError naming the file and the system's reason.
std::string read_file(const std::filesystem::path& path);

}  // namespace supple
