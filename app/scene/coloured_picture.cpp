#include <app/report/exit_guard.hpp>
#include <app/scene/coloured_picture.hpp>

#include <cmath>

namespace supple {

namespace {

/// The end of a scale that holds all scalars of the objects: their largest, rounded up to two digits.
double scale_end(const std::vector<PictureObject>& objects) {
  double largest = 0;
  for (const PictureObject& object : objects)
    if (object.scalar.size() > 0) largest = std::max(largest, object.scalar.maxCoeff());
  if (!(largest > 0)) return 1;
  const double unit = std::pow(10, std::floor(std::log10(largest)) - 1);
  return std::ceil(largest / unit * (1 - 1e-12)) * unit;
}

}  // namespace

void write_picture(const std::filesystem::path& path, const std::vector<PictureObject>& objects,
                   PictureOptions options) {
  const Image image = draw_picture(objects, options);
  const ExitGuard guard(path);
  write_png(path, image);
}

void write_coloured_picture(const std::filesystem::path& path, const std::vector<PictureObject>& objects,
                            const std::string& label, int width, int height) {
  PictureOptions options;
  options.width = width;
  options.height = height;
  options.scale.label = label;
  options.scale.low = 0.0;
  options.scale.high = scale_end(objects);
  write_picture(path, objects, options);
}

}  // namespace supple
