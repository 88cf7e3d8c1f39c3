#pragma once
/// \file Ctrl-C ends the command at once, but never in the middle of a file.

#include <mutex>

namespace supple {

/// From now on a thread of its own waits for SIGINT, SIGTERM and SIGHUP. Call it before any other thread
/// starts.
void watch_for_signals();

/// While one lives, signals wait: hold it from opening a file to its last byte.
class [[nodiscard]] ExitGuard {
 public:
  ExitGuard();

 private:
  std::unique_lock<std::recursive_mutex> lock_;
};

}  // namespace supple
