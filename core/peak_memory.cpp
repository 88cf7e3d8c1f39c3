#include <core/peak_memory.hpp>

#include <sys/resource.h>

namespace supple {

double peak_resident_memory() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? 1024.0 * static_cast<double>(usage.ru_maxrss) : 0;
}

}  // namespace supple
