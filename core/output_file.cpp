#include <core/check.hpp>
#include <core/output_file.hpp>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <mutex>
#include <set>
#include <string>
#include <system_error>
#include <unistd.h>
#include <utility>

namespace supple {

namespace {

/// The number N if the path leads to /dev/fd/N of this process, as /dev/stderr does; else −1.
int own_descriptor(std::filesystem::path path) {
  std::error_code no_link;
  const std::filesystem::path descriptors = std::filesystem::canonical("/proc/self/fd", no_link);
  for (int links = 0; links < 40 && std::filesystem::is_symlink(path, no_link); ++links) {
    const std::filesystem::path folder =
        std::filesystem::canonical(path.has_parent_path() ? path.parent_path() : ".", no_link);
    if (folder == descriptors && !descriptors.empty()) return std::atoi(path.filename().c_str());
    path = folder / std::filesystem::read_symlink(path, no_link);
  }
  return -1;
}

/// Temporary files that are there now.
struct Unfinished {
  std::mutex mutex;
  std::set<std::filesystem::path> paths;
};
Unfinished& unfinished() {
  static auto* const files = new Unfinished;  // outlives whoever ends the process
  return *files;
}

std::filesystem::path follow_links(const std::filesystem::path& path) {
  std::error_code no_link;
  const bool follow = std::filesystem::is_symlink(path, no_link) && !is_stream(path);
  return follow ? std::filesystem::weakly_canonical(path, no_link) : path;
}

}  // namespace

bool is_stream(const std::filesystem::path& path) {
  std::error_code unknown;
  const std::filesystem::file_status status = std::filesystem::status(path, unknown);
  return exists(status) && !is_directory(status) && (!is_regular_file(status) || own_descriptor(path) >= 0);
}

OutputFile::OutputFile(const std::filesystem::path& path) : path_(follow_links(path)) {
  if (!path_.has_filename()) throw InputError(path.string() + ": cannot be written: it names no file");
  if (std::error_code unknown; std::filesystem::is_directory(path_, unknown))
    throw InputError(path.string() + ": cannot be written: it is a folder");
  if (is_stream(path_)) {
    const int open_already = own_descriptor(path_);  // which goes on where others left it
    descriptor_ =
        open_already >= 0 ? ::fcntl(open_already, F_DUPFD_CLOEXEC, 0) : ::open(path_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) fail("open");
    return;
  }
  static std::atomic<unsigned> serial{0};
  const std::lock_guard lock(unfinished().mutex);
  do {
    temporary_ = path_.parent_path() / ("." + path_.filename().string() + "." + std::to_string(::getpid()) + "-" +
                                        std::to_string(serial++) + ".tmp");
    descriptor_ = ::open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && errno == EEXIST);
  if (descriptor_ < 0) fail("create");
  unfinished().paths.insert(temporary_);
}

OutputFile::~OutputFile() {
  if (descriptor_ < 0) return;
  ::close(descriptor_);
  if (temporary_.empty()) return;
  const std::lock_guard lock(unfinished().mutex);
  ::unlink(temporary_.c_str());
  unfinished().paths.erase(temporary_);
}

void OutputFile::write(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) fail("write");
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

void OutputFile::commit() {
  if (temporary_.empty()) {
    if (::close(std::exchange(descriptor_, -1)) != 0) fail("write");
    return;
  }
  if (::fsync(descriptor_) != 0) fail("write");
  {
    const std::lock_guard lock(unfinished().mutex);
    if (::rename(temporary_.c_str(), path_.c_str()) != 0) fail("replace");
    unfinished().paths.erase(temporary_);
  }
  ::close(descriptor_);
  descriptor_ = -1;
  // The new name is on the disk only once its folder is; where folders cannot be synchronised, the file still
  // is.
  const std::filesystem::path folder = path_.has_parent_path() ? path_.parent_path() : ".";
  if (const int directory = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC); directory >= 0) {
    ::fsync(directory);
    ::close(directory);
  }
}

void OutputFile::fail(const char* action) const {
  throw InputError(path_.string() + ": cannot " + action + ": " + std::strerror(errno));
}

void abandon_output_files() {
  unfinished().mutex.lock();
  for (const std::filesystem::path& path : unfinished().paths) ::unlink(path.c_str());
}

void write_file(const std::filesystem::path& path, std::string_view content) {
  OutputFile file(path);
  file.write(content);
  file.commit();
}

std::string read_file(const std::filesystem::path& path) {
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
  std::string content;
  ssize_t count = descriptor < 0 ? -1 : 0;
  for (std::size_t size = 0; descriptor >= 0; size += static_cast<std::size_t>(count)) {
    content.resize(size + std::max<std::size_t>(size / 2, 1 << 16));
    do count = ::read(descriptor, content.data() + size, content.size() - size);
    while (count < 0 && errno == EINTR);
    if (count > 0) continue;
    content.resize(size);
    break;
  }
  const int error = errno;
  if (descriptor >= 0) ::close(descriptor);
  if (count < 0) throw InputError(path.string() + ": cannot be read: " + std::strerror(error));
  return content;
}

}  // namespace supple
