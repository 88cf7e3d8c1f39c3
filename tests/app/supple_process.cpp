#include <core/output_file.hpp>
#include <tests/app/supple_process.hpp>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <fstream>
#include <functional>
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

/// \param wait  called with the process's number before the signal is sent.
/// \param device  that stdout goes to; null: into the outcome.
Outcome run(const Arguments& arguments, const std::filesystem::path& folder, bool terminal, int signal = 0,
            const std::function<void(pid_t)>& wait = {}, const char* device = nullptr) {
  int out[2], err[2];
  if (pipe(out) != 0) throw std::runtime_error("no pipe");
  if (terminal) {
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
    dup2(device ? open(device, O_WRONLY) : out[1], STDOUT_FILENO);
    dup2(err[1], STDERR_FILENO);
    for (const int descriptor : {out[0], out[1], err[0], err[1]}) close(descriptor);
    if (chdir(folder.c_str()) == 0) execv(argv[0], argv.data());
    _exit(127);
  }
  close(out[1]);
  close(err[1]);
  Outcome outcome;
  std::thread reader([&] { outcome.err = drain(err[0]); });
  if (signal != 0) {
    wait(child);
    kill(child, signal);
    kill(child, SIGCONT);
  }
  outcome.out = drain(out[0]);
  int status = 0;
  waitpid(child, &status, 0);
  reader.join();
  outcome.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return outcome;
}

}  // namespace

Outcome run_supple(const Arguments& arguments, const std::filesystem::path& folder) {
  return run(arguments, folder, false);
}
Outcome run_supple_on_terminal(const Arguments& arguments, const std::filesystem::path& folder) {
  return run(arguments, folder, true);
}
Outcome run_supple_on_full_disk(const Arguments& arguments, const std::filesystem::path& folder) {
  return run(arguments, folder, false, 0, {}, "/dev/full");
}
Outcome run_supple_until_signal(const Arguments& arguments, const std::filesystem::path& folder, int signal,
                                int milliseconds) {
  return run(arguments, folder, false, signal,
             [&](pid_t) { std::this_thread::sleep_for(std::chrono::milliseconds(milliseconds)); });
}
Outcome run_supple_until_signal_while_writing(const Arguments& arguments, const std::filesystem::path& folder,
                                              int signal) {
  const auto is_writing = [&] {
    for (const auto& entry : std::filesystem::directory_iterator(folder))
      if (entry.path().extension() == ".tmp") return true;
    return false;
  };
  const auto start = std::chrono::steady_clock::now();
  return run(arguments, folder, false, signal, [&](pid_t child) {
    while (std::chrono::steady_clock::now() - start < std::chrono::seconds(60)) {
      if (is_writing()) {  // held there, however long this process waits for its turn
        kill(child, SIGSTOP);
        waitpid(child, nullptr, WUNTRACED);
        if (is_writing()) return;
        kill(child, SIGCONT);
      }
      std::this_thread::yield();
    }
  });
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
