#pragma once
/// \file A pack of eight numbers that behaves like one: the second scalar type of every element formula.

#include <core/types.hpp>

#include <cmath>

#ifdef __AVX512F__
#include <immintrin.h>
#endif

namespace supple {

/// Eight doubles, operated on lane by lane with the vector instructions at hand. Its size and alignment (64
/// bytes) do not depend on compiler flags.
struct alignas(64) Pack {
  static constexpr int size = 8;
  using Lanes = double __attribute__((vector_size(size * sizeof(double))));

  Lanes lanes;

  Pack() = default;
  Pack(double value) : lanes(value - Lanes{}) {}
  Pack(int value) : Pack(static_cast<double>(value)) {}
  Pack(Lanes value) : lanes(value) {}

  /// p points to eight doubles, aligned to 64 bytes.
  static Pack load(const double* p) { return {*reinterpret_cast<const Aliased*>(p)}; }
  static Pack load_unaligned(const double* p) { return {Lanes(*reinterpret_cast<const Unaligned*>(p))}; }
  void store(double* p) const { *reinterpret_cast<Aliased*>(p) = lanes; }
  void store_unaligned(double* p) const { *reinterpret_cast<Unaligned*>(p) = lanes; }

  double operator[](int lane) const { return lanes[lane]; }
  void set(int lane, double value) { lanes[lane] = value; }

  Pack operator-() const { return {-lanes}; }
  Pack& operator+=(const Pack& b) {
    lanes += b.lanes;
    return *this;
  }
  Pack& operator-=(const Pack& b) {
    lanes -= b.lanes;
    return *this;
  }
  Pack& operator*=(const Pack& b) {
    lanes *= b.lanes;
    return *this;
  }
  Pack& operator/=(const Pack& b) {
    lanes /= b.lanes;
    return *this;
  }
  friend Pack operator+(Pack a, const Pack& b) { return a += b; }
  friend Pack operator-(Pack a, const Pack& b) { return a -= b; }
  friend Pack operator*(Pack a, const Pack& b) { return a *= b; }
  friend Pack operator/(Pack a, const Pack& b) { return a /= b; }

  double sum() const {
    return ((lanes[0] + lanes[4]) + (lanes[2] + lanes[6])) + ((lanes[1] + lanes[5]) + (lanes[3] + lanes[7]));
  }

 private:
  using Aliased = double __attribute__((vector_size(size * sizeof(double)), may_alias));
  using Unaligned = double __attribute__((vector_size(size * sizeof(double)), may_alias, aligned(8)));
};

/// f in every lane.
template <typename Function>
Pack map_lanes(const Pack& a, Function f) {
  Pack result;
  for (int k = 0; k < Pack::size; ++k) result.set(k, f(a[k]));
  return result;
}

inline Pack sqrt(const Pack& a) {
#ifdef __AVX512F__
  return {Pack::Lanes(_mm512_sqrt_pd(__m512d(a.lanes)))};
#else
  return map_lanes(a, [](double x) { return std::sqrt(x); });
#endif
}
inline Pack abs(const Pack& a) {
  return {a.lanes < 0 ? -a.lanes : a.lanes};
}
inline Pack min(const Pack& a, const Pack& b) {
  return {a.lanes < b.lanes ? a.lanes : b.lanes};
}
inline Pack max(const Pack& a, const Pack& b) {
  return {a.lanes > b.lanes ? a.lanes : b.lanes};
}
inline Pack log(const Pack& a) {
  return map_lanes(a, [](double x) { return std::log(x); });
}
inline Pack exp(const Pack& a) {
  return map_lanes(a, [](double x) { return std::exp(x); });
}
inline Pack cbrt(const Pack& a) {
  return map_lanes(a, [](double x) { return std::cbrt(x); });
}
inline Pack acos(const Pack& a) {
  return map_lanes(a, [](double x) { return std::acos(x); });
}
inline Pack atan2(const Pack& y, const Pack& x) {
  Pack result;
  for (int k = 0; k < Pack::size; ++k) result.set(k, std::atan2(y[k], x[k]));
  return result;
}
inline Pack pow(const Pack& a, double exponent) {
  return map_lanes(a, [exponent](double x) { return std::pow(x, exponent); });
}

/// Where a > 0, then; elsewhere, otherwise.
inline Pack where_positive(const Pack& a, const Pack& then, const Pack& otherwise) {
  return {a.lanes > 0 ? then.lanes : otherwise.lanes};
}
inline double where_positive(double a, double then, double otherwise) {
  return a > 0 ? then : otherwise;
}

}  // namespace supple

template <>
struct Eigen::NumTraits<supple::Pack> : Eigen::NumTraits<double> {
  using Real = supple::Pack;
  using NonInteger = supple::Pack;
  using Nested = supple::Pack;
  using Literal = double;
  enum {
    IsComplex = 0,
    IsInteger = 0,
    IsSigned = 1,
    RequireInitialization = 0,
    ReadCost = 1,
    AddCost = 1,
    MulCost = 1
  };
};
template <typename BinaryOp>
struct Eigen::ScalarBinaryOpTraits<supple::Pack, double, BinaryOp> {
  using ReturnType = supple::Pack;
};
template <typename BinaryOp>
struct Eigen::ScalarBinaryOpTraits<double, supple::Pack, BinaryOp> {
  using ReturnType = supple::Pack;
};
