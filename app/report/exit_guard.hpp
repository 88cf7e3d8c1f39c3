#pragma once
/// \file Guard against Ctrl-C in the middle of a file; elsewhere it ends the command at once.

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>

namespace supple {

/// Blocks SIGINT, SIGTERM and SIGHUP in this thread and all that it starts, so that they reach nobody but the thread of
/// watch_for_signals(). To be called before libraries are initialised: OpenBLAS starts threads then, and METIS, while it
/// orders a matrix, takes SIGTERM for itself, gives up the ordering and forgets the signal.
void hold_signals();

/// From now on a thread of its own waits for these signals, and ends the process when no ExitGuard lives. \pre hold_signals()
void watch_for_signals();

/// What is said on stderr if a signal ends the process from now on: one line, such as where results so far are kept.
void on_signal_say(std::string text);

/// What is done if a signal ends the process from now on, in the thread that waits for it: what takes a moment at most, such
/// as taking leave of clients.
void on_signal_do(std::function<void()> last);

/// What the process ends with where it would have ended with `code` by itself: 128 + the signal that came before, whose
/// thread may still be waiting for its turn.
int exit_code(int code);

/// While one lives, signals wait: hold it from opening a file to its last byte.
class [[nodiscard]] ExitGuard {
 public:
  ExitGuard();
  /// For one file; a stream, which may take forever and holds nothing to lose, is not guarded.
  explicit ExitGuard(const std::filesystem::path& file);

 private:
  std::unique_lock<std::recursive_mutex> lock_;
};

}  // namespace supple
