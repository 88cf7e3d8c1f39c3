#include <core/output_file.hpp>
#include <tests/app/supple_process.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace supple::test {

namespace {

std::string drain(int descriptor) {
  std::string text;
  char buffer[4096];
  for (ssize_t count; (count = ::read(descriptor, buffer, sizeof buffer)) > 0;) text.append(buffer, count);
  close(descriptor);  // a terminal whose other side is closed ends with an error instead of 0
  return text;
}

struct Circumstances {
  bool terminal = false;         ///< that stderr goes to
  const char* device = nullptr;  ///< that stdout goes to; null: into the outcome
  std::size_t largest_file = 0;  ///< [bytes]; 0: as large as it likes
  int signal = 0;                ///< sent to it; 0: none
  /// Called with the process's number and its stdout before the signal is sent.
  std::function<void(pid_t, int)> wait = {};
};

Outcome run(const Arguments& arguments, const std::filesystem::path& folder, const Circumstances& given = {}) {
  int out[2], err[2];
  if (pipe(out) != 0) throw std::runtime_error("no pipe");
  if (given.terminal) {
    err[0] = posix_openpt(O_RDWR | O_NOCTTY);
    if (err[0] < 0 || grantpt(err[0]) != 0 || unlockpt(err[0]) != 0) throw std::runtime_error("no terminal");
    err[1] = open(ptsname(err[0]), O_RDWR | O_NOCTTY);
  } else if (pipe(err) != 0) {
    throw std::runtime_error("no pipe");
  }
  std::vector<std::string> words{SUPPLE_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    if (given.largest_file > 0) {
      const rlimit limit{given.largest_file, given.largest_file};
      setrlimit(RLIMIT_FSIZE, &limit);
      std::signal(SIGXFSZ, SIG_IGN);  // what is too large fails then, as on a full disk
    }
    dup2(given.device ? open(given.device, O_WRONLY) : out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    for (const int descriptor : {out[0], out[1], err[0], err[1]}) close(descriptor);
    if (chdir(folder.c_str()) == 0) execv(argv[0], argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  Outcome outcome;
  std::thread reader([&] { outcome.err = drain(err[0]); });
  if (given.signal != 0) {
    given.wait(child, out[0]);
    kill(child, given.signal);
    kill(child, SIGCONT);
  }
  outcome.out = drain(out[0]);
  int status = 0;
  waitpid(child, &status, 0);
  reader.join();
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return outcome;
}

bool is_writing(const std::filesystem::path& folder) {
  std::error_code gone;  // a file may be renamed meanwhile
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder, gone))
    if (entry.path().extension() == ".tmp") return true;
  return false;
}

/// Waits until it has opened a file to write, and holds it there, however long this process waits for its turn.
void hold_while_writing(pid_t child, const std::filesystem::path& folder) {
  const auto start = std::chrono::steady_clock::now();
  while (std::chrono::steady_clock::now() - start < std::chrono::seconds(60)) {
    if (is_writing(folder)) {
      siginfo_t info{};
      kill(child, SIGSTOP);
      waitid(P_PID, static_cast<id_t>(child), &info, WSTOPPED | WEXITED | WNOWAIT);
      if (is_writing(folder) || info.si_code != CLD_STOPPED) return;
      kill(child, SIGCONT);
    }
    std::this_thread::yield();
  }
}

}  // namespace

Outcome run_supple(const Arguments& arguments, const std::filesystem::path& folder) {
  return run(arguments, folder);
}
Outcome run_supple_on_terminal(const Arguments& arguments, const std::filesystem::path& folder) {
  return run(arguments, folder, {.terminal = true});
}
Outcome run_supple_on_full_disk(const Arguments& arguments, const std::filesystem::path& folder) {
  return run(arguments, folder, {.device = "/dev/full"});
}
Outcome run_supple_with_largest_file(const Arguments& arguments, const std::filesystem::path& folder,
                                     std::size_t bytes) {
  return run(arguments, folder, {.largest_file = bytes});
}
Outcome run_supple_until_signal(const Arguments& arguments, const std::filesystem::path& folder, int signal,
                                std::chrono::microseconds after) {
  return run(arguments, folder, {.signal = signal, .wait = [&](pid_t, int) { std::this_thread::sleep_for(after); }});
}
Outcome run_supple_until_signal_while_writing(const Arguments& arguments, const std::filesystem::path& folder,
                                              int signal) {
  return run(arguments, folder,
             {.signal = signal, .wait = [&](pid_t child, int) { hold_while_writing(child, folder); }});
}
Outcome run_supple_until_signal_once_it_prints(const Arguments& arguments, const std::filesystem::path& folder,
                                               int signal) {
  return run(arguments, folder, {.signal = signal, .wait = [](pid_t, int out) {
                                   pollfd printed{out, POLLIN, 0};
                                   (void)poll(&printed, 1, 60'000);  // [ms]
                                 }});
}

SuppleProcess::SuppleProcess() {
  std::string name = (std::filesystem::temp_directory_path() / "supple_app_XXXXXX").string();
  if (!mkdtemp(name.data())) throw std::runtime_error("no temporary folder");
  folder = name;
}

SuppleProcess::~SuppleProcess() {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

nlohmann::json SuppleProcess::report(Arguments arguments) const {
  arguments.insert(arguments.end(), {"--json", "-"});
  const Outcome outcome = supple(arguments);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_EQ(outcome.err, "");
  nlohmann::json json = nlohmann::json::parse(outcome.out, nullptr, false);
  EXPECT_FALSE(json.is_discarded()) << outcome.out;
  return json;
}

void SuppleProcess::expect_refusal(const Arguments& arguments, const std::vector<std::string>& parts, int code) const {
  const Outcome outcome = supple(arguments);
  EXPECT_EQ(outcome.exit_code, code) << outcome.err;
  EXPECT_EQ(std::count(outcome.err.begin(), outcome.err.end(), '\n'), 1) << outcome.err;
  EXPECT_EQ(outcome.err.rfind("supple: ", 0), 0u) << outcome.err;
  for (const std::string& part : parts)
    EXPECT_NE(outcome.err.find(part), std::string::npos) << part << " in " << outcome.err;
}

void SuppleProcess::write(const std::string& name, const std::string& text) const {
  std::ofstream(folder / name, std::ios::binary) << text;
}
std::string SuppleProcess::read(const std::filesystem::path& name) const {
  return read_file(folder / name);
}

std::vector<std::string> SuppleProcess::files() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

}  // namespace supple::test
