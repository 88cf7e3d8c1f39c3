/// \file The targets as libFuzzer's: PROGRAM list, or PROGRAM TARGET CORPUS [OPTION OF LIBFUZZER ...]. The corpus is a folder,
/// into which the seeds are written first. Targets are those of the function SUPPLE_FUZZ_TARGETS.

#include <tests/fuzz/fuzz_target.hpp>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <optional>
#include <unistd.h>

namespace {

using namespace supple::fuzz;

std::optional<Target> target;
std::filesystem::path folder;

void remove_folder() {
  std::error_code ignored;
  std::filesystem::remove_all(folder, ignored);
}

}  // namespace

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv) {
  const std::vector<std::string> words(*argv + 1, *argv + *argc);
  for (const Target& some : SUPPLE_FUZZ_TARGETS()) {
    if (words == std::vector<std::string>{"list"}) std::puts(some.name.c_str());
    if (words.size() > 1 && some.name == words[0]) target = some;
  }
  if (!target) std::exit(words == std::vector<std::string>{"list"} ? 0 : 2);
  std::filesystem::create_directories(words[1]);
  const std::vector<std::string> seeds = target->seeds();
  for (std::size_t k = 0; k < seeds.size(); ++k)
    put(std::filesystem::path(words[1]) / ("seed_" + std::to_string(k)), seeds[k]);
  folder = std::filesystem::temp_directory_path() / ("supple_fuzz_" + std::to_string(::getpid()));
  std::filesystem::create_directories(folder);
  std::atexit(remove_folder);
  std::rotate(*argv + 1, *argv + 2, *argv + *argc);  // libFuzzer takes the rest
  --*argc;
  return 0;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::clock_t start = std::clock();  // of this process, whatever else the machine does
  (void)target->read({reinterpret_cast<const char*>(data), size}, folder);
  demand(std::clock() - start < CLOCKS_PER_SEC, "more than a second for " + std::to_string(size) + " bytes");
  return 0;
}
