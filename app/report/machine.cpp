#include <app/report/machine.hpp>
#include <core/parallel.hpp>

#include <fstream>

namespace supple {

std::string processor_name() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);)
    if (const std::size_t at = line.find(": "); line.starts_with("model name") && at != std::string::npos)
      return line.substr(at + 2);
  return "unknown processor";
}

std::string machine_in_words() {
  return processor_name() + ", " + std::to_string(num_threads()) + (num_threads() == 1 ? " thread" : " threads");
}

}  // namespace supple
