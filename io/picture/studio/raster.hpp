#pragma once
/// \file Raster of a picture: which triangle and which ball stands in each sample of each pixel.

#include <io/picture/studio/lens.hpp>
#include <io/picture/studio/scene.hpp>

#include <cstdint>
#include <vector>

namespace supple::studio {

/// What stands in the samples of a band of rows.
struct Band {
  static constexpr std::uint32_t nothing = ~0u;

  int first_row, rows;  ///< in pixels
  int columns, lines;   ///< in samples
  int samples;          ///< along each axis of a pixel
  std::vector<float> nearness, ball_nearness;
  std::vector<std::uint32_t> face, ball;  ///< those of balls are empty if the scene has none

  bool has_ball(std::size_t sample) const { return !ball.empty() && ball[sample] != nothing; }
  /// Sample (i, j) of pixel x in row y of the band.
  std::size_t sample(int x, int y, int i, int j) const {
    return (static_cast<std::size_t>(y) * samples + j) * columns + static_cast<std::size_t>(x) * samples + i;
  }
};

/// Draws in bands of rows, each by one thread in buffers that stay in the cache.
class Raster {
 public:
  static constexpr int band_rows = 18;

  /// Keeps references to scene and lens.
  Raster(const Scene& scene, const Lens& lens, int width, int height, int samples);

  const Projection& projected(std::uint32_t vertex) const { return projected_[vertex]; }
  int num_bands() const { return static_cast<int>(faces_of_band_.size()); }
  Band draw(int index) const;

 private:
  void draw_face(Band& band, std::uint32_t f) const;
  void draw_ball(Band& band, std::uint32_t k) const;

  const Scene& scene_;
  const Lens& lens_;
  int width_, height_, samples_;
  std::vector<Projection> projected_;
  std::vector<std::vector<std::uint32_t>> faces_of_band_;
};

}  // namespace supple::studio
