#include <core/check.hpp>
#include <core/output_file.hpp>
#include <io/picture/plot.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <regex>
#include <unistd.h>

namespace supple {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;
using testing::ThrowsMessage;

struct PlotTest : testing::Test {
  PlotTest() {
    fs::create_directories(folder);
    plot.series.push_back({"a", Vector::LinSpaced(5, 1, 5), Vector::LinSpaced(5, 2, 9)});
  }
  ~PlotTest() override { fs::remove_all(folder); }

  std::string svg() const {
    draw_plot(folder / "plot.svg", plot);
    return read_file(folder / "plot.svg");
  }

  const fs::path folder = fs::temp_directory_path() / ("supple plot's-" + std::to_string(::getpid()));
  Plot plot{.title = "title", .x = {"time [s]"}, .y = {"energy [J]"}, .series = {}};
};

#define SKIP_WITHOUT_GNUPLOT \
  if (!can_plot()) GTEST_SKIP() << "gnuplot is not installed"

TEST_F(PlotTest, SvgShowsTitleLabelsAndLegend) {
  SKIP_WITHOUT_GNUPLOT;
  const std::string text = svg();
  EXPECT_THAT(text, StartsWith("<?xml"));
  for (const char* words : {"title", "time [s]", "energy [J]", ">a<"}) EXPECT_THAT(text, HasSubstr(words));
  EXPECT_THAT(text, HasSubstr("</svg>"));
}

TEST_F(PlotTest, ShowsLabelsBesidePointsWhateverIsInThem) {
  SKIP_WITHOUT_GNUPLOT;
  plot.series[0].style = PlotStyle::Markers;
  plot.series[0].labels = {"90, 120", "x_1^2", "it's", "a \"quoted\\ one", ""};
  plot.series[0].y[1] = std::numeric_limits<double>::quiet_NaN();  // a point that is not there has no label
  const std::string text = svg();
  EXPECT_THAT(text, HasSubstr("90, 120"));
  EXPECT_THAT(text, Not(HasSubstr("x_1")));
  EXPECT_THAT(text, HasSubstr("quoted"));
  plot.series[0].labels.pop_back();
  EXPECT_THAT([&] { svg(); }, ThrowsMessage<std::invalid_argument>(HasSubstr("labels of series 'a'")));
}

TEST_F(PlotTest, LogAxesOfLessThanTwoPowersOfTenHaveMoreNumbersThanThose) {
  SKIP_WITHOUT_GNUPLOT;
  plot.y.scale = Scale::Log;
  plot.series[0].y *= 1e-3;  // 0.002 to 0.009
  for (const char* number : {"0.002", "0.005"}) EXPECT_THAT(svg(), HasSubstr(number));
  plot.series[0].y[0] = 10;  // four powers of ten
  EXPECT_THAT(svg(), Not(HasSubstr("0.002")));
}

TEST_F(PlotTest, EvenShortLogAxesHaveTwoNumbers) {
  SKIP_WITHOUT_GNUPLOT;
  plot.y = {.label = "error", .scale = Scale::Log};
  plot.series[0].x *= 1000;  // whose numbers are others
  for (const double low : {1.2, 2.2, 5.3, 7.0}) {
    plot.y.low = low;
    plot.y.high = 1.69 * low;
    plot.series[0].y.setLinSpaced(low * 1.1, low * 1.5);
    const std::string text = svg();
    int numbers = 0;
    for (const char* number : {"1.2", "1.5", "2", "2.5", "3", "6", "7", "8", "9", "10"})
      numbers += text.find(std::string(">") + number + "<") != std::string::npos;
    EXPECT_GE(numbers, 2) << low;
  }
}

TEST_F(PlotTest, ManySeriesAreToldApart) {
  SKIP_WITHOUT_GNUPLOT;
  const PlotSeries one = plot.series[0];
  plot.series.clear();
  for (int k = 0; k < 13; ++k) {
    plot.series.push_back(one);
    plot.series.back().style = PlotStyle::LinePoints;
    plot.series.back().name = "series " + std::to_string(k);
  }
  EXPECT_THAT(svg(), HasSubstr("stroke-dasharray"));  // from the eighth on, where colours begin anew
}

TEST_F(PlotTest, PngHasTheSizeThatWasAskedFor) {
  SKIP_WITHOUT_GNUPLOT;
  plot.width = 320;
  plot.height = 200;
  draw_plot(folder / "plot.png", plot);
  const std::string bytes = read_file(folder / "plot.png");
  ASSERT_GT(bytes.size(), 24u);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  const auto number = [&](std::size_t at) {
    unsigned value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = 256 * value + static_cast<unsigned char>(bytes[at + k]);
    return value;
  };
  EXPECT_EQ(number(16), 320u);
  EXPECT_EQ(number(20), 200u);
}

TEST_F(PlotTest, TextsAreShownLetterByLetterAndNeverExecuted) {
  SKIP_WITHOUT_GNUPLOT;
  const fs::path trap = folder / "trap";
  plot.title = "it's `touch '" + trap.string() + "'` \\n \"x\" $data END";
  plot.series[0].name = "w_i^{2} & 'more'\nEND";
  plot.x.label = "@x {/Symbol a} – µs";
  const std::string text = svg();
  EXPECT_FALSE(fs::exists(trap));
  for (const char* words : {"it&apos;s `touch", "w_i^{2} &amp; ", "@x {/Symbol a} – µs"})
    EXPECT_TRUE(text.find(words) != text.npos ||
                text.find(std::regex_replace(words, std::regex("&apos;"), "'")) != text.npos)
        << words << "\n"
        << text;
}

TEST_F(PlotTest, GapsInterruptTheLine) {
  SKIP_WITHOUT_GNUPLOT;
  const auto moves = [](const std::string& text) {  // of the curve: its path starts anew after each gap
    const std::size_t curve = text.find("gnuplot_plot_1");
    const std::string path =
        text.substr(text.find("<path", curve), text.find("/>", text.find("<path", curve)) - text.find("<path", curve));
    return std::count(path.begin(), path.end(), 'M');
  };
  plot.series[0].name.clear();
  EXPECT_EQ(moves(svg()), 1);
  plot.series[0].y[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(moves(svg()), 2);
  plot.series[0].y[2] = -1;
  EXPECT_EQ(moves(svg()), 1);
  plot.y.scale = Scale::Log;
  EXPECT_EQ(moves(svg()), 2);
}

TEST_F(PlotTest, LogAxesHavePowersOfTen) {
  SKIP_WITHOUT_GNUPLOT;
  EXPECT_THAT(svg(), Not(HasSubstr("dy=\"-")));
  plot.y.scale = plot.x.scale = Scale::Log;
  plot.series[0].y[4] = 1e4;
  EXPECT_THAT(svg(), HasSubstr("dy=\"-"));  // an exponent is raised
}

TEST_F(PlotTest, NumbersStandAtTheGivenTicks) {
  SKIP_WITHOUT_GNUPLOT;
  plot.x.scale = Scale::Log;
  plot.x.ticks = {1.25, 1.5};
  const std::string text = svg();
  for (const char* number : {">1.25<", ">1.5<"}) EXPECT_THAT(text, HasSubstr(number));
}

TEST_F(PlotTest, RefusesWhatCannotBeShown) {
  const auto refuse = [&](const Plot& wrong, const std::string& reason) {
    EXPECT_THAT([&] { draw_plot(folder / "plot.svg", wrong); },
                ThrowsMessage<std::invalid_argument>(HasSubstr(reason)));
  };
  Plot wrong = plot;
  wrong.series.clear();
  refuse(wrong, "has no series");
  wrong = plot;
  wrong.series[0].y.resize(4);
  refuse(wrong, "y of series 'a' has size 4, expected 5");
  wrong = plot;
  wrong.series[0].y *= -1;
  wrong.y.scale = Scale::Log;
  refuse(wrong, "no point that can be shown");
  wrong = plot;
  wrong.x.low = 2, wrong.x.high = 1;
  refuse(wrong, "the axis 'time [s]' is empty");
  wrong.x = {"t", Scale::Log, 0.0};
  refuse(wrong, "not positive on a log axis");
  wrong = plot;
  wrong.width = 20;
  refuse(wrong, "has 20 x 600 pixels");
  EXPECT_THAT([&] { draw_plot(folder / "plot.jpg", plot); },
              ThrowsMessage<InputError>(HasSubstr("ends in .svg or .png")));
}

TEST_F(PlotTest, SaysThatGnuplotIsMissingOrFailed) {
  const std::string path = std::getenv("PATH");
  const auto message = [&] {
    try {
      draw_plot(folder / "plot.svg", plot);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  ::setenv("PATH", folder.c_str(), 1);
  EXPECT_FALSE(can_plot());
  EXPECT_THAT(message(), HasSubstr("gnuplot is not installed"));
  write_file(folder / "gnuplot", "#!/bin/sh\necho out of ink >&2\nexit 3\n");
  fs::permissions(folder / "gnuplot", fs::perms::owner_all);
  EXPECT_THAT(message(), HasSubstr("gnuplot failed: out of ink"));
  ::setenv("PATH", path.c_str(), 1);
  EXPECT_FALSE(fs::exists(folder / "plot.svg"));
}

}  // namespace
}  // namespace supple
