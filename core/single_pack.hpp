#pragma once
/// \file Pack of eight numbers kept in single precision, computed with in double.

#include <core/pack.hpp>

namespace supple {

/// Half the memory of a Pack; rounds what is set to it, a relative error of at most 6e-8.
struct alignas(32) SinglePack {
  using Lanes = float __attribute__((vector_size(Pack::size * sizeof(float))));

  Lanes lanes;

  SinglePack() = default;
  void set(int lane, double value) { lanes[lane] = static_cast<float>(value); }
  operator Pack() const {
#ifdef __AVX512F__
    return {Pack::Lanes(_mm512_cvtps_pd(__m256(lanes)))};  // one instruction, of which GCC 12 makes three
#else
    return {__builtin_convertvector(lanes, Pack::Lanes)};
#endif
  }
};

}  // namespace supple
