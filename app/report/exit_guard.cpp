#include <app/report/exit_guard.hpp>
#include <app/report/terminal.hpp>
#include <core/output_file.hpp>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <fcntl.h>
#include <string>
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
int caught[2];  // a pipe from the handler, in which hardly anything is allowed, to the thread

void pass_on(int signal) {
  const int error = errno;
  last_signal = signal;
  const auto number = static_cast<unsigned char>(signal);
  [[maybe_unused]] const ssize_t written = ::write(caught[1], &number, 1);
  errno = error;
}

}  // namespace

void watch_for_signals() {
  if (::pipe2(caught, O_CLOEXEC) != 0) return;
  files();
  std::thread([] {
    unsigned char signal = 0;
    while (::read(caught[0], &signal, 1) != 1)
      if (errno != EINTR) return;
    const std::lock_guard lock(files());
    if (last_deed()) last_deed()();
    clear_progress();
    abandon_output_files();
    if (!farewell().empty()) std::fprintf(stderr, "supple: %s\n", farewell().c_str());
    _exit(128 + signal);
  }).detach();
  struct sigaction handler {};
  handler.sa_handler = pass_on;
  handler.sa_flags = SA_RESTART;
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction current {};
    if (sigaction(signal, nullptr, &current) == 0 && current.sa_handler == SIG_IGN) continue;  // as under nohup
    sigaction(signal, &handler, nullptr);
  }
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
