#pragma once
/// \file Machine that times were measured on, in words.

#include <string>

namespace supple {

/// The processor's name, or "unknown processor" where the system does not tell.
std::string processor_name();
/// "Xeon E5-2680, 4 threads"
std::string machine_in_words();

}  // namespace supple
