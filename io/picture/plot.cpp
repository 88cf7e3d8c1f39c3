#include <core/check.hpp>
#include <core/output_file.hpp>
#include <core/text.hpp>
#include <io/picture/plot.hpp>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <limits>
#include <memory>
#include <spawn.h>
#include <sys/wait.h>
#include <tuple>
#include <unistd.h>

extern char** environ;

namespace supple {

namespace {

/// A qualitative palette that stays distinct for the common colour deficiencies (Okabe and Ito 2008), dark
/// ones first.
constexpr std::array palette{"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#4d4d4d"};
constexpr std::array point_types{7, 5, 9, 13, 11, 6, 4};

/// A text in single quotes, inside which gnuplot replaces nothing.
std::string gnuplot_string(std::string_view words) {
  std::string result = "'";
  for (const char c : words) {
    if (c == '\'') result += '\'';
    result += static_cast<unsigned char>(c) < 32 ? ' ' : c;
  }
  return result + "'";
}

/// A text in double quotes, as data blocks take it; what would end it or mean something else there is left out.
std::string data_string(std::string_view words) {
  std::string result = "\"";
  for (const char c : words) result += c == '"' || c == '\\' || static_cast<unsigned char>(c) < 32 ? ' ' : c;
  return result + "\"";
}

/// Runs a program on `input`, collecting what it writes. Files instead of pipes: nobody waits for anybody.
struct Run {
  int error = 0;  // of starting the program
  int status = 0;
  std::string output, messages;
};
Run run(std::vector<std::string> command, std::string_view input) {
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
  const auto temporary = [] {
    File file(std::tmpfile(), &std::fclose);
    if (!file) throw InputError(std::string("cannot create a temporary file: ") + std::strerror(errno));
    return file;
  };
  const auto content = [](std::FILE* file) {
    std::string bytes;
    std::array<char, 1 << 14> block;
    std::rewind(file);
    while (const std::size_t count = std::fread(block.data(), 1, block.size(), file)) bytes.append(block.data(), count);
    return bytes;
  };
  const File in = temporary(), out = temporary(), messages = temporary();
  if (std::fwrite(input.data(), 1, input.size(), in.get()) != input.size() || std::fflush(in.get()) != 0)
    throw InputError(std::string("cannot write a temporary file: ") + std::strerror(errno));
  std::rewind(in.get());

  std::vector<char*> arguments;
  for (std::string& word : command) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(in.get()), 0);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(out.get()), 1);
  ::posix_spawn_file_actions_adddup2(&actions, ::fileno(messages.get()), 2);
  posix_spawnattr_t attributes;  // a process group of its own: Ctrl-C is for the caller, who may be writing a file
  ::posix_spawnattr_init(&attributes);
  sigset_t none;  // and it holds no signals back, whatever the caller does
  sigemptyset(&none);
  ::posix_spawnattr_setsigmask(&attributes, &none);
  ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGMASK);
  Run result;
  pid_t child = 0;
  result.error = ::posix_spawnp(&child, arguments[0], &actions, &attributes, arguments.data(), environ);
  ::posix_spawnattr_destroy(&attributes);
  ::posix_spawn_file_actions_destroy(&actions);
  if (result.error == 0)
    while (::waitpid(child, &result.status, 0) < 0 && errno == EINTR) continue;
  result.output = content(out.get());
  result.messages = content(messages.get());
  return result;
}

bool shown(const Plot& plot, double x, double y) {
  return std::isfinite(x) && std::isfinite(y) && (plot.x.scale == Scale::Linear || x > 0) &&
         (plot.y.scale == Scale::Linear || y > 0);
}

void check(const Plot& plot) {
  require(!plot.series.empty(), "a plot has no series");
  require(100 <= plot.width && plot.width <= 10000 && 100 <= plot.height && plot.height <= 10000,
          "a plot has " + std::to_string(plot.width) + " x " + std::to_string(plot.height) +
              " pixels, expected 100 to 10000 each way");
  for (const Axis& axis : {plot.x, plot.y}) {
    for (const std::optional<double>& end : {axis.low, axis.high})
      require(!end || (std::isfinite(*end) && (axis.scale == Scale::Linear || *end > 0)),
              "an end of the axis '" + axis.label + "' is not finite, or not positive on a log axis");
    require(!axis.low || !axis.high || *axis.low < *axis.high, "the axis '" + axis.label + "' is empty");
  }
  bool any = false;
  for (const PlotSeries& series : plot.series) {
    require_size("y of series '" + series.name + "'", series.y.size(), series.x.size());
    if (!series.labels.empty())
      require_size("labels of series '" + series.name + "'", static_cast<Index>(series.labels.size()), series.x.size());
    for (Index k = 0; k < series.x.size(); ++k) any = any || shown(plot, series.x[k], series.y[k]);
  }
  require(any, "a plot has no point that can be shown");
}

/// A corner of the plot without points, or else beside it: where the legend hides nothing.
std::string place_of_legend(const Plot& plot) {
  const auto along = [](const Axis& axis, double value) { return axis.scale == Scale::Log ? std::log(value) : value; };
  std::vector<Eigen::Array2d> points;
  Eigen::Array2d low = Eigen::Array2d::Constant(std::numeric_limits<double>::infinity()), high = -low;
  for (const PlotSeries& series : plot.series)
    for (Index k = 0; k < series.x.size(); ++k) {
      if (!shown(plot, series.x[k], series.y[k])) continue;
      points.emplace_back(along(plot.x, series.x[k]), along(plot.y, series.y[k]));
      low = low.min(points.back());
      high = high.max(points.back());
    }
  for (const auto& [name, x, y] :
       {std::tuple{"top right", 1, 1}, {"top left", 0, 1}, {"bottom right", 1, 0}, {"bottom left", 0, 0}}) {
    const Eigen::Array2d corner(x, y), reach(0.35, 0.1 + 0.06 * static_cast<double>(plot.series.size()));
    const bool hides = std::ranges::any_of(points, [&](const Eigen::Array2d& point) {
      return ((((point - low) / (high - low).max(1e-300)) - corner).abs() < reach).all();
    });
    if (!hides) return name;
  }
  return "outside right top";
}

/// The axis, whose coordinates are these `values` of the series, with numbers where it is logarithmic and spans less than
/// two powers of ten: those alone would leave it all but bare.
Axis with_ticks(const Plot& plot, Axis axis, Vector PlotSeries::*values) {
  if (axis.scale == Scale::Linear || !axis.ticks.empty()) return axis;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (const PlotSeries& series : plot.series)
    for (Index k = 0; k < series.x.size(); ++k)
      if (shown(plot, series.x[k], series.y[k])) {
        low = std::min(low, (series.*values)[k]);
        high = std::max(high, (series.*values)[k]);
      }
  low = axis.low.value_or(low);
  high = axis.high.value_or(high);
  if (high >= 100 * low) return axis;
  const std::vector<std::vector<double>> coarse_to_fine{{1, 2, 5}, {1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9}};
  for (const std::vector<double>& digits : coarse_to_fine) {
    axis.ticks.clear();
    for (double power = std::pow(10, std::floor(std::log10(low))); power <= high; power *= 10)
      for (const double digit : digits)
        if (0.5 * low <= digit * power && digit * power <= 2 * high) axis.ticks.push_back(digit * power);
    if (std::ranges::count_if(axis.ticks, [&](double tick) { return low <= tick && tick <= high; }) > 1) break;
  }
  return axis;
}

std::string axis_commands(const char* name, const Axis& axis) {
  const std::string x(name);
  std::string commands = "set " + x + "label " + gnuplot_string(axis.label) + " noenhanced\n";
  commands += "set " + x + "range [" + (axis.low ? exact(*axis.low) : "*") + ":" +
              (axis.high ? exact(*axis.high) : "*") + "]\n";
  if (axis.scale == Scale::Log && axis.ticks.empty())
    commands += "set logscale " + x + " 10\nset format " + x + " '10^{%L}'\nset m" + x + "tics 10\n";
  else
    commands += (axis.scale == Scale::Log ? "set logscale " + x + "\n" : "") + "set format " + x + " '%.6g'\n";
  std::string ticks;
  for (const double tick : axis.ticks) ticks += (ticks.empty() ? "" : ", ") + exact(tick);
  if (!ticks.empty()) commands += "set " + x + "tics (" + ticks + ")\n";
  return commands;
}

std::string style_commands(PlotStyle style, std::size_t series) {
  const std::string colour = " linecolor rgb '" + std::string(palette[series % palette.size()]) + "'";
  const std::size_t round = series / palette.size();  // in the second one colours meet other markers and dots
  const std::string points =
      " pointsize 1 pointtype " + std::to_string(point_types[(series + 3 * round) % point_types.size()]);
  const std::string dots = round % 2 == 1 ? " dashtype (2,4)" : "";
  switch (style) {
    case PlotStyle::Line:
      return "with lines linewidth 2" + dots + colour;
    case PlotStyle::Markers:
      return "with points" + points + colour;
    case PlotStyle::LinePoints:
      return "with linespoints linewidth 2" + dots + points + colour;
    case PlotStyle::DashedLine:
      return "with lines linewidth 2 dashtype (12,7)" + colour;
  }
  return "";
}

std::string script(const Plot& plot, const std::string& terminal) {
  std::string commands =
      "set encoding utf8\n"
      "set terminal " +
      terminal + " enhanced size " + std::to_string(plot.width) + "," + std::to_string(plot.height) +
      " font 'Helvetica,14' background rgb 'white'\n"
      "set border 3 linecolor rgb '#606060' linewidth 1\n"
      "set tics nomirror out scale 0.6 textcolor rgb '#404040'\n"
      "set grid xtics ytics back linetype 1 linecolor rgb '#e2e2e2' linewidth 1\n"
      "set key " +
      place_of_legend(plot) +
      " Left reverse opaque noenhanced samplen 2.5 spacing 1.15 width 1 textcolor rgb '#303030'\n"
      "set lmargin 11\nset datafile missing 'NaN'\n";
  if (!plot.title.empty())
    commands += "set title " + gnuplot_string(plot.title) + " noenhanced font 'Helvetica,17' textcolor rgb '#202020'\n";
  commands += axis_commands("x", with_ticks(plot, plot.x, &PlotSeries::x));
  commands += axis_commands("y", with_ticks(plot, plot.y, &PlotSeries::y));

  std::string curves;
  for (std::size_t k = 0; k < plot.series.size(); ++k) {
    const PlotSeries& series = plot.series[k];
    const std::string block = "$series" + std::to_string(k);
    commands += block + " << END\n";
    for (Index i = 0; i < series.x.size(); ++i) {
      // An empty line interrupts the curve.
      if (shown(plot, series.x[i], series.y[i])) {
        commands += exact(series.x[i]) + " " + exact(series.y[i]);
        if (!series.labels.empty()) commands += " " + data_string(series.labels[static_cast<std::size_t>(i)]);
      }
      commands += "\n";
    }
    commands += "END\n";
    curves += (k > 0 ? ", " : "") + block + " using 1:2 " + style_commands(series.style, k) +
              (series.name.empty() ? " notitle" : " title " + gnuplot_string(series.name) + " noenhanced");
    if (!series.labels.empty())
      curves += ", " + block +
                " using 1:2:3 with labels left offset 0.7,0.7 noenhanced font 'Helvetica,12' textcolor rgb '#404040' "
                "notitle";
  }
  return commands + "plot " + curves + "\n";
}

}  // namespace

bool can_plot() {
  const Run gnuplot = run({"gnuplot", "--version"}, "");
  return gnuplot.error == 0 && gnuplot.status == 0;
}

void draw_plot(const std::filesystem::path& path, const Plot& plot) {
  const std::string extension = path.extension().string();
  if (extension != ".svg" && extension != ".png")
    throw InputError(path.string() + ": expected a name that ends in .svg or .png");
  check(plot);
  const Run gnuplot = run({"gnuplot", "-d"}, script(plot, extension == ".svg" ? "svg" : "pngcairo"));
  if (gnuplot.error == ENOENT)
    throw InputError(path.string() + ": cannot be drawn: gnuplot is not installed (Debian: gnuplot-nox)");
  if (gnuplot.error != 0)
    throw InputError(path.string() + ": cannot be drawn: gnuplot does not start: " + std::strerror(gnuplot.error));
  if (gnuplot.status != 0 || gnuplot.output.empty())
    throw InputError(path.string() + ": cannot be drawn: gnuplot failed: " + gnuplot.messages.substr(0, 2000));
  std::string picture = gnuplot.output;
  using namespace std::string_view_literals;
  if (const std::string_view end = extension == ".svg" ? "</svg>\n\n"sv : "IEND\xae\x42\x60\x82"sv;
      !picture.ends_with(end))
    throw InputError(path.string() + ": cannot be drawn: gnuplot's picture is cut short: " + std::strerror(EFBIG) +
                     ", or " + std::strerror(ENOSPC));
  constexpr std::string_view title = "<title>Gnuplot</title>\n";  // which browsers would show
  if (const auto at = picture.find(title); extension == ".svg" && at != std::string::npos)
    picture.erase(at, title.size());
  write_file(path, picture);
}

}  // namespace supple
