#pragma once
/// \file Images: pixels, text on them, and PNG files.

#include <io/picture/colour.hpp>

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <vector>

namespace supple {

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> pixels;  ///< red, green, blue in sRGB, row by row from the top

  Image() = default;
  Image(int width, int height, const Colour& fill = {1, 1, 1});

  Colour at(int x, int y) const;
  void set(int x, int y, const Colour& colour);
};

enum class TextAlign { Left, Centre, Right };

/// Width in pixels of a line whose capitals are `size` pixels high.
double text_width(std::string_view text, double size);
/// Draws a line of text; (x, y) is its left end, middle or right end on the baseline.
void draw_text(Image& image, double x, double y, std::string_view text, double size, const Colour& colour,
               TextAlign align = TextAlign::Left);

/// \throws InputError if the file cannot be written; std::invalid_argument if the image is empty.
void write_png(const std::filesystem::path& path, const Image& image);
/// \throws InputError naming the file if it cannot be read or is not a PNG file.
Image read_png(const std::filesystem::path& path);

}  // namespace supple
