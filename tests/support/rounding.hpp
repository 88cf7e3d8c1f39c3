#pragma once
/// \file How far apart two ways to one number may come out.

namespace supple::test {

/// Of formulas of a few hundred operations, relative to the largest of their terms.
inline constexpr double rounding = 1e-12;

}  // namespace supple::test
