#pragma once
/// \file Line plots, drawn by gnuplot.

#include <core/types.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace supple {

enum class Scale { Linear, Log };

struct Axis {
  std::string label;  ///< with the unit, as "time [s]"
  Scale scale = Scale::Linear;
  std::optional<double> low = {}, high = {};  ///< ends; fitted to the data unless given
  std::vector<double> ticks = {};             ///< where numbers stand; chosen unless given
};

enum class PlotStyle {
  Line,
  Markers,     ///< measurements
  LinePoints,  ///< few points that belong to one another
  DashedLine,  ///< a reference, a bound, a model
};

struct PlotSeries {
  std::string name;  ///< in the legend; empty: not there
  Vector x, y;       ///< of one size; a NaN interrupts the line, and so does what a log axis cannot show
  PlotStyle style = PlotStyle::Line;
  std::vector<std::string> labels = {};  ///< a few characters beside each point; empty: none
};

struct Plot {
  std::string title = {};
  Axis x = {}, y = {};
  std::vector<PlotSeries> series;
  int width = 960, height = 600;  ///< pixels
};

/// Draws to `path`: .svg or .png by its extension. Old files are replaced in one step.
/// \throws std::invalid_argument if there is no series, x, y and labels differ in size, nothing can be shown, an end
/// of a log axis is not positive, or a picture is smaller than 100 or larger than 10 000 pixels; InputError
/// if the extension is another, gnuplot is not installed or fails (with its message), or the file cannot be
/// written.
void draw_plot(const std::filesystem::path& path, const Plot& plot);

/// Whether gnuplot can be run.
bool can_plot();

}  // namespace supple
