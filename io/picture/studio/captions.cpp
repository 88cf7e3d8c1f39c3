#include <core/check.hpp>
#include <io/picture/studio/captions.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace supple::studio {

namespace {

constexpr unsigned ink = 0x2b3440;
// Parts of the picture that stay free, and sizes on it, as shares of its height.
constexpr double margin = 0.05, caption_margin = 0.105, bar_margin = 0.18, caption_size = 0.0185;

bool has_bar(std::span<const PictureObject> objects, const ScalarScale& scale) {
  return !scale.label.empty() &&
         std::ranges::any_of(objects, [](const auto& object) { return object.scalar.size() > 0; });
}

bool has_captions(std::span<const PictureObject> objects) {
  return std::ranges::any_of(objects, [](const auto& object) { return !object.caption.empty(); });
}

/// All captions are as small as the tightest one needs.
double size_of_captions(const Image& image, std::span<const PictureObject> objects, const View& view) {
  double size = caption_size * image.height;
  const double edge = 0.4 * margin * image.height;
  const auto count = objects.size();
  for (std::size_t k = 0; k < count; ++k) {
    if (objects[k].caption.empty()) continue;
    double room = 2 * std::min(view.caption_x[k] - edge, image.width - edge - view.caption_x[k]);
    for (std::size_t other = 0; other < count; ++other)
      if (other != k && !objects[other].caption.empty())
        room = std::min(room, std::abs(view.caption_x[other] - view.caption_x[k]) - size);
    const double width = text_width(objects[k].caption, size);
    if (width > room) size *= std::max(0.4, room / width);
  }
  return size;
}

void draw_bar(Image& image, const ScalarScale& scale, const View& view) {
  const double H = image.height, size = 0.85 * caption_size * H;
  const int top = static_cast<int>(0.27 * H), bottom = static_cast<int>(0.73 * H);
  const int left = static_cast<int>(image.width - 0.16 * H), right = left + std::max(4, static_cast<int>(0.02 * H));
  for (int y = top; y < bottom; ++y)
    for (int x = std::max(0, left); x < right; ++x)
      image.set(x, y, map_colour(scale.map, 1 - (y + 0.5 - top) / (bottom - top)));
  for (const double share : {0.0, 0.5, 1.0}) {
    char number[32];
    std::snprintf(number, sizeof number, "%.4g", view.scalar_low + share * (view.scalar_high - view.scalar_low));
    std::string text(number);
    if (text.starts_with('-')) text.replace(0, 1, "−");
    draw_text(image, right + 0.6 * size, bottom + share * (top - bottom) + 0.5 * size, text, size, rgb(ink));
  }
  const double end = image.width - 0.5 * margin * H, width = text_width(scale.label, size);
  draw_text(image, std::min(end - width, static_cast<double>(left)), top - 1.8 * size, scale.label, size, rgb(ink));
}

}  // namespace

Window free_window(std::span<const PictureObject> objects, const PictureOptions& options) {
  const double W = options.width, H = options.height;
  const double left = W / 2 - margin * H, right = left - (has_bar(objects, options.scale) ? bar_margin * H : 0);
  const double top = H / 2 - margin * H, bottom = H / 2 - (has_captions(objects) ? caption_margin : margin) * H;
  require(left + right > 0, "a picture is too narrow for its colour bar");
  return {left, right, top, bottom};
}

void draw_captions(Image& image, std::span<const PictureObject> objects, const ScalarScale& scale, const View& view) {
  const double size = size_of_captions(image, objects, view);
  for (std::size_t k = 0; k < objects.size(); ++k)
    draw_text(image, view.caption_x[k], image.height * (1 - 0.45 * caption_margin), objects[k].caption, size, rgb(ink),
              TextAlign::Centre);
  if (has_bar(objects, scale)) draw_bar(image, scale, view);
}

}  // namespace supple::studio
