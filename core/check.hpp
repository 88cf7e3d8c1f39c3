#pragma once
/// \file Checks of arguments, and the exceptions of the library: a caller's mistake throws and names itself.

#include <core/types.hpp>

#include <stdexcept>
#include <string>
#include <string_view>

namespace supple {

/// No answer exists: a matrix that must be positive definite is not, a factorisation failed.
struct SolverError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// A file or an input that cannot be used; what() names file, place and expectation.
struct InputError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// \throws std::invalid_argument "u has size 5, expected 6"
inline void require_size(std::string_view name, Index size, Index expected) {
  if (size != expected)
    throw std::invalid_argument(std::string(name) + " has size " + std::to_string(size) + ", expected " +
                                std::to_string(expected));
}

/// \throws std::invalid_argument with the message if the condition does not hold.
inline void require(bool condition, const std::string& message) {
  if (!condition) throw std::invalid_argument(message);
}

}  // namespace supple
