#include <io/picture/colour.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace supple {

namespace {

/// Lightness, chroma and hue [deg] in Oklab.
struct Lch {
  double L, C, h;
};

Eigen::Vector3d linear_rgb(const Lch& lch) {
  const double hue = lch.h * std::numbers::pi / 180, a = lch.C * std::cos(hue), b = lch.C * std::sin(hue);
  const Eigen::Array3d lms{lch.L + 0.3963377774 * a + 0.2158037573 * b, lch.L - 0.1055613458 * a - 0.0638541728 * b,
                           lch.L - 0.0894841775 * a - 1.2914855480 * b};
  const Eigen::Vector3d cubes = lms.cube();
  Eigen::Matrix3d to_rgb;
  to_rgb << 4.0767416621, -3.3077115913, 0.2309699292,  //
      -1.2684380046, 2.6097574011, -0.3413193965,       //
      -0.0041960863, -0.7034186147, 1.7076147010;
  return to_rgb * cubes;
}

/// As colourful as asked, or as the screen allows at this lightness and hue.
Colour screen_colour(Lch lch) {
  const auto fits = [&](double C) {
    const Eigen::Vector3d linear = linear_rgb({lch.L, C, lch.h});
    return linear.minCoeff() >= 0 && linear.maxCoeff() <= 1;
  };
  if (!fits(lch.C)) {
    double low = 0;
    for (double high = lch.C; high - low > 1e-6;) (fits(0.5 * (low + high)) ? low : high) = 0.5 * (low + high);
    lch.C = low;
  }
  return to_screen(linear_rgb(lch).cast<float>());
}

template <std::size_t count>
Lch interpolate(const std::array<Lch, count>& stops, double share) {
  const double at = share * (count - 1);
  const auto k = std::min(static_cast<std::size_t>(at), count - 2);
  const double t = at - static_cast<double>(k);
  const Lch &a = stops[k], &b = stops[k + 1];
  return {a.L + t * (b.L - a.L), a.C + t * (b.C - a.C), a.h + t * (b.h - a.h)};
}

}  // namespace

Eigen::Vector3f to_linear(const Colour& colour) {
  const auto decode = [](double c) { return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4); };
  return {static_cast<float>(decode(colour.r)), static_cast<float>(decode(colour.g)),
          static_cast<float>(decode(colour.b))};
}

Colour to_screen(const Eigen::Vector3f& linear) {
  const auto encode = [](double c) {
    c = std::clamp(c, 0.0, 1.0);
    return c <= 0.0031308 ? 12.92 * c : 1.055 * std::pow(c, 1 / 2.4) - 0.055;
  };
  return {encode(linear[0]), encode(linear[1]), encode(linear[2])};
}

Colour map_colour(ColourMap map, double share) {
  if (std::isnan(share)) return {0.6, 0.6, 0.6};
  share = std::clamp(share, 0.0, 1.0);
  if (map == ColourMap::Sequential) {
    static constexpr std::array<Lch, 5> stops{
        {{0.30, 0.13, 295}, {0.455, 0.12, 258}, {0.61, 0.10, 200}, {0.765, 0.15, 150}, {0.92, 0.17, 104}}};
    return screen_colour(interpolate(stops, share));
  }
  const double side = std::abs(2 * share - 1);
  return screen_colour({0.955 - 0.50 * std::pow(side, 1.15), 0.17 * side, share < 0.5 ? 255.0 : 30.0});
}

}  // namespace supple
