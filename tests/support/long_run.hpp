#pragma once
/// \file How much a test repeats: little in every run, much where SUPPLE_LONG=1 is in the environment.

#include <cstdlib>
#include <string_view>

namespace supple::test {

inline bool is_long_run() {
  const char* setting = std::getenv("SUPPLE_LONG");
  return setting && std::string_view(setting) == "1";
}
inline int repetitions(int quick, int long_run) {
  return is_long_run() ? long_run : quick;
}

}  // namespace supple::test
