#pragma once
/// \file Signs that weights may have.

namespace supple {

/// The weights that a fit may take.
enum class Signs { NonNegative, Any };

/// The weights that a selector gives: S::signs if it has that, or else non-negative ones.
template <typename S>
constexpr Signs signs_of() {
  if constexpr (requires { Signs{S::signs}; })
    return S::signs;
  else
    return Signs::NonNegative;
}

}  // namespace supple
