#include <app/report/exit_guard.hpp>
#include <app/report/terminal.hpp>
#include <core/output_file.hpp>

#include <array>
#include <atomic>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <string>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace supple {

namespace {

std::recursive_mutex& files() {
  static auto* const mutex = new std::recursive_mutex;  // outlives the thread that waits
  return *mutex;
}

std::string& farewell() {
  static auto* const text = new std::string;
  return *text;
}

std::function<void()>& last_deed() {
  static auto* const deed = new std::function<void()>;
  return *deed;
}

std::atomic<int> last_signal = 0;
constexpr std::array signals_that_end{SIGINT, SIGTERM, SIGHUP};

/// Those that whoever started the process does not have ignored, as under nohup.
sigset_t awaited() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals_that_end) {
    struct sigaction current {};
    if (sigaction(signal, nullptr, &current) != 0 || current.sa_handler != SIG_IGN) sigaddset(&set, signal);
  }
  return set;
}

}  // namespace

// Before the C library and the sanitizers are ready: no call of theirs.
[[gnu::no_sanitize("address", "thread", "undefined")]] void hold_signals() {
  std::uint64_t mask = 0;
  for (const int signal : signals_that_end) mask |= std::uint64_t{1} << (signal - 1);
  ::syscall(SYS_rt_sigprocmask, SIG_BLOCK, &mask, nullptr, sizeof mask);
}

void watch_for_signals() {
  files();
  std::thread([set = awaited()] {
    int signal = 0;
    while (sigwait(&set, &signal) != 0) continue;
    last_signal = signal;
    const std::lock_guard lock(files());
    if (last_deed()) last_deed()();
    clear_progress();
    abandon_output_files();
    if (!farewell().empty()) std::fprintf(stderr, "supple: %s\n", farewell().c_str());
    _exit(128 + signal);
  }).detach();
}

void on_signal_say(std::string text) {
  const std::lock_guard lock(files());
  farewell() = std::move(text);
}

void on_signal_do(std::function<void()> last) {
  const std::lock_guard lock(files());
  last_deed() = std::move(last);
}

int exit_code(int code) {
  return last_signal == 0 ? code : 128 + last_signal;
}

ExitGuard::ExitGuard() : lock_(files()) {}
ExitGuard::ExitGuard(const std::filesystem::path& file) {
  if (!is_stream(file)) lock_ = std::unique_lock(files());
}

}  // namespace supple
