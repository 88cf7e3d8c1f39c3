#pragma once
/// \file Checks of what is typed after an option, beyond those of CLI11: each says what it expected.

#include <core/types.hpp>

#include <CLI/CLI.hpp>

namespace supple {

/// A whole number of at least `least` that fits into 63 bits, without sign, point or exponent.
CLI::Validator whole_number(Index least = 1);
/// Finite, too.
CLI::Validator positive_number();
CLI::Validator number_between(double low, double high);
/// Names of subspaces, and sums of them.
CLI::Validator subspace_name();

}  // namespace supple
