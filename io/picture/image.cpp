#include <core/check.hpp>
#include <core/output_file.hpp>
#include <io/picture/image.hpp>
#include <io/picture/stroke_font.hpp>

#include <png.h>

#include <algorithm>
#include <cmath>

namespace supple {

namespace {

std::uint8_t to_byte(double value) {
  return static_cast<std::uint8_t>(std::lround(255 * std::clamp(value, 0.0, 1.0)));
}

float distance(const Eigen::Vector2f& p, const TextStrokes::Segment& s) {
  const Eigen::Vector2f along = s.b - s.a;
  const float t = std::clamp((p - s.a).dot(along) / std::max(along.squaredNorm(), 1e-12f), 0.f, 1.f);
  return (p - s.a - t * along).norm();
}

}  // namespace

Image::Image(int image_width, int image_height, const Colour& fill)
    : width(image_width), height(image_height), pixels(3 * static_cast<std::size_t>(image_width) * image_height) {
  for (std::size_t k = 0; k < pixels.size(); k += 3) {
    pixels[k] = to_byte(fill.r);
    pixels[k + 1] = to_byte(fill.g);
    pixels[k + 2] = to_byte(fill.b);
  }
}

Colour Image::at(int x, int y) const {
  const std::uint8_t* pixel = pixels.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  return {pixel[0] / 255.0, pixel[1] / 255.0, pixel[2] / 255.0};
}

void Image::set(int x, int y, const Colour& colour) {
  std::uint8_t* pixel = pixels.data() + 3 * (static_cast<std::size_t>(y) * width + x);
  pixel[0] = to_byte(colour.r);
  pixel[1] = to_byte(colour.g);
  pixel[2] = to_byte(colour.b);
}

double text_width(std::string_view text, double size) {
  return lay_out(text).width * size;
}

void draw_text(Image& image, double x, double y, std::string_view text, double size, const Colour& colour,
               TextAlign align) {
  const TextStrokes line = lay_out(text);
  if (align == TextAlign::Centre) x -= 0.5 * size * line.width;
  if (align == TextAlign::Right) x -= size * line.width;
  const double half = 0.5 * stroke_thickness * size;
  // Coverage of each pixel by the nearest stroke, gathered over all strokes that come near.
  const int left = static_cast<int>(std::floor(x - half)) - 2,
            top = static_cast<int>(std::floor(y - stroke_ascent * size - half)) - 1;
  const int columns = static_cast<int>(std::ceil(size * line.width + 2 * half)) + 4;
  const int rows = static_cast<int>(std::ceil((stroke_ascent + stroke_descent) * size + 2 * half)) + 2;
  std::vector<float> coverage(static_cast<std::size_t>(columns) * rows, 0.f);
  for (const TextStrokes::Segment& stroke : line.segments) {
    const auto to_pixels = [&](const Eigen::Vector2f& p) {
      return Eigen::Vector2f(static_cast<float>(x - left + size * p.x()), static_cast<float>(y - top - size * p.y()));
    };
    const TextStrokes::Segment s{to_pixels(stroke.a), to_pixels(stroke.b)};
    const float reach = static_cast<float>(half) + 1;
    const Eigen::Vector2f low = s.a.cwiseMin(s.b).array() - reach, high = s.a.cwiseMax(s.b).array() + reach;
    for (int j = std::max(0, static_cast<int>(low.y())); j < std::min(rows, static_cast<int>(high.y()) + 1); ++j)
      for (int i = std::max(0, static_cast<int>(low.x())); i < std::min(columns, static_cast<int>(high.x()) + 1); ++i) {
        const float inside = static_cast<float>(half) + 0.5f - distance({i + 0.5f, j + 0.5f}, s);
        float& covered = coverage[static_cast<std::size_t>(j) * columns + i];
        covered = std::max(covered, std::clamp(inside, 0.f, 1.f));
      }
  }
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      const double a = coverage[static_cast<std::size_t>(j) * columns + i];
      const int px = left + i, py = top + j;
      if (a == 0 || px < 0 || py < 0 || px >= image.width || py >= image.height) continue;
      const Colour below = image.at(px, py);
      image.set(
          px, py,
          {below.r + a * (colour.r - below.r), below.g + a * (colour.g - below.g), below.b + a * (colour.b - below.b)});
    }
}

void write_png(const std::filesystem::path& path, const Image& image) {
  require(image.width > 0 && image.height > 0, "an image has no pixels");
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  png.width = static_cast<png_uint_32>(image.width);
  png.height = static_cast<png_uint_32>(image.height);
  png.format = PNG_FORMAT_RGB;
  png_alloc_size_t size = 0;
  std::string bytes;
  const auto encode = [&](void* memory) {
    if (!png_image_write_to_memory(&png, memory, &size, 0, image.pixels.data(), 0, nullptr))
      throw InputError(path.string() + ": cannot be written: " + png.message);
  };
  encode(nullptr);  // counts the bytes
  bytes.resize(size);
  encode(bytes.data());
  write_file(path, std::string_view(bytes).substr(0, size));
}

Image read_png(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  png_image png{};
  png.version = PNG_IMAGE_VERSION;
  const auto refuse = [&] { throw InputError(path.string() + ": not a readable PNG file: " + png.message); };
  if (!png_image_begin_read_from_memory(&png, bytes.data(), bytes.size())) refuse();
  constexpr png_uint_32 largest = 1 << 15;
  constexpr std::size_t most_pixels_a_byte = 1032 * 8;  // deflated, a bit each
  const auto refuse_size = [&](const char* why) {
    png_image_free(&png);
    throw InputError(path.string() + ": " + why);
  };
  if (png.width > largest || png.height > largest) refuse_size("is larger than 32768 pixels");
  if (std::size_t{png.width} * png.height > most_pixels_a_byte * bytes.size())
    refuse_size("announces more pixels than the file can hold");
  png.format = PNG_FORMAT_RGB;
  Image image(static_cast<int>(png.width), static_cast<int>(png.height));
  if (!png_image_finish_read(&png, nullptr, image.pixels.data(), 0, nullptr)) refuse();
  return image;
}

}  // namespace supple
