#include <app/exit_guard.hpp>
#include <app/terminal.hpp>

#include <csignal>
#include <thread>
#include <unistd.h>

namespace supple {

namespace {

std::recursive_mutex& files() {
  static auto* const mutex = new std::recursive_mutex;  // outlives the thread that waits
  return *mutex;
}

}  // namespace

void watch_for_signals() {
  sigset_t ending;
  sigemptyset(&ending);
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction current {};
    if (sigaction(signal, nullptr, &current) == 0 && current.sa_handler == SIG_IGN) continue;  // as under nohup
    sigaddset(&ending, signal);
  }
  pthread_sigmask(SIG_BLOCK, &ending, nullptr);
  files();
  std::thread([ending] {
    int signal = 0;
    if (sigwait(&ending, &signal) != 0) return;
    const std::lock_guard lock(files());
    clear_progress();
    _exit(128 + signal);
  }).detach();
}

ExitGuard::ExitGuard() : lock_(files()) {}

}  // namespace supple
