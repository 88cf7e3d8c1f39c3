#pragma once
/// \file Pack of eight numbers that behaves like one number: the second scalar type of every element formula.

#include <core/eigen_scalar.hpp>
#include <core/intrinsics.hpp>
#include <core/types.hpp>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <numbers>

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
  static Pack load_unaligned(const double* p) {
    Pack result;
    std::memcpy(&result.lanes, p, sizeof(Lanes));
    return result;
  }
  void store(double* p) const { *reinterpret_cast<Aliased*>(p) = lanes; }
  void store_unaligned(double* p) const { std::memcpy(p, &lanes, sizeof(Lanes)); }

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
/// The angle of the point (x, y), −π … π, without calls or branches: within 2.5 units in the last place
/// for finite arguments whose sum is, too; zeros and their signs as in std::atan2; NaN if an argument is.
/// With t = min / max of |y|, |x|: atan t below tan(π/8), else π/4 + atan((t − 1) / (t + 1)); then
/// atan t ≈ t + t³ P(t²), P the Chebyshev interpolant of degree 10, within 6e-18.
inline Pack atan2(const Pack& y, const Pack& x) {
  using Lanes = Pack::Lanes;
  using Bits = std::int64_t __attribute__((vector_size(sizeof(Lanes))));
  constexpr double quarter = std::numbers::pi / 4, half = std::numbers::pi / 2, whole = std::numbers::pi;
  constexpr double rest = 0x1.1a62633145c07p-55;  // π/4 − quarter
  const Bits sign = Bits{} + std::numeric_limits<std::int64_t>::min();
  const Lanes abs_y = Lanes(Bits(y.lanes) & ~sign), abs_x = Lanes(Bits(x.lanes) & ~sign);
  const auto steep = abs_y > abs_x;
  const Lanes high = steep ? abs_y : abs_x, low = steep ? abs_x : abs_y;
  const auto middle = low > 0.41421356237309503 * high;  // tan(π/8)
  const Lanes denominator = middle ? low + high : high;
  const Lanes t = (middle ? low - high : low) / (denominator == 0 ? Lanes{} + 1 : denominator);
  const Lanes z = t * t;
  const Lanes z2 = z * z, z4 = z2 * z2;
  const Lanes p0 =
      (-0x1.5555555555555p-2 + z * 0x1.999999999934cp-3) + z2 * (-0x1.2492492436201p-3 + z * 0x1.c71c71853d7c8p-4);
  const Lanes p4 =
      (-0x1.745d0b28a7649p-4 + z * 0x1.3b12630643e8ap-4) + z2 * (-0x1.10fa77b104ae8p-4 + z * 0x1.dfe6497394f40p-5);
  const Lanes p8 = (-0x1.a0999c2994d42p-5 + z * 0x1.4162bf84bf0bfp-5) + z2 * -0x1.3a31b0297d745p-6;
  const Lanes atan_t = t + t * (z * (p0 + z4 * (p4 + z4 * p8)));
  Lanes angle = middle ? quarter + (atan_t + rest) : atan_t;
  angle = steep ? half - (angle - 2 * rest) : angle;
  angle = Bits(x.lanes) < 0 ? whole - (angle - 4 * rest) : angle;
  return {Lanes(Bits(angle) | (Bits(y.lanes) & sign))};
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

/// Whether a lane is positive: to skip what vanishes in all of them.
inline bool any_positive(const Pack& a) {
  bool any = false;
  for (int k = 0; k < Pack::size; ++k) any |= a[k] > 0;
  return any;
}
inline bool any_positive(double a) {
  return a > 0;
}

}  // namespace supple

template <>
struct Eigen::NumTraits<supple::Pack> : supple::RealScalarTraits<supple::Pack> {};
template <typename BinaryOp>
struct Eigen::ScalarBinaryOpTraits<supple::Pack, double, BinaryOp> {
  using ReturnType = supple::Pack;
};
template <typename BinaryOp>
struct Eigen::ScalarBinaryOpTraits<double, supple::Pack, BinaryOp> {
  using ReturnType = supple::Pack;
};
