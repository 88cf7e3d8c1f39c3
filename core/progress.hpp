#pragma once
/// \file Progress of long work, told by a callback: the library prints nothing; the caller decides.

#include <functional>
#include <string_view>

namespace supple {

/// Called with the name of the stage and its finished share in [0, 1]; from one thread at a time. May be
/// empty.
using Progress = std::function<void(std::string_view stage, double share)>;

inline void tell(const Progress& progress, std::string_view stage, double share) {
  if (progress) progress(stage, share);
}

}  // namespace supple
