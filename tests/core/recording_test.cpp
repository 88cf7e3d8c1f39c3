#include <core/random.hpp>
#include <core/recording.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <string>

namespace supple::test {
namespace {

using Handles = std::vector<Recording::Handle>;

/// A formula of three variables, over any scalar type.
struct Formula {
  std::string name;
  std::function<double(double, double, double)> number;
  std::function<Recorded(Recorded, Recorded, Recorded)> recorded;
};
template <typename F>
Formula formula(std::string name, F f) {
  return {std::move(name), [f](double x, double y, double z) { return f(x, y, z); },
          [f](Recorded x, Recorded y, Recorded z) { return f(x, y, z); }};
}

std::vector<Formula> formulas() {
  using std::sqrt, std::cbrt, std::exp, std::log, std::acos, std::abs, std::atan2, std::min, std::max, std::pow;
  return {
      formula("sum", [](auto x, auto y, auto z) { return x + y - z + 2.0; }),
      formula("product", [](auto x, auto y, auto z) { return x * y * z * x; }),
      formula("quotient", [](auto x, auto y, auto z) { return x / (y + 3.0 * z) - 1.0 / x; }),
      formula("negation", [](auto x, auto y, auto z) { return -x * -(y - z) + -(-z); }),
      formula("sqrt", [](auto x, auto y, auto z) { return sqrt(x * y + z); }),
      formula("cbrt", [](auto x, auto y, auto z) { return cbrt(x - y * 6.0) * z; }),
      formula("exp", [](auto x, auto y, auto z) { return exp(x * y) - exp(-z); }),
      formula("log", [](auto x, auto y, auto z) { return log(x) * log(y + z); }),
      formula("acos", [](auto x, auto y, auto z) { return acos(x * y) + z; }),
      formula("abs", [](auto x, auto y, auto z) { return abs(x - 0.9) * abs(y) + z; }),
      formula("atan2", [](auto x, auto y, auto z) { return atan2(x - 0.9, y) * z; }),
      formula("min and max", [](auto x, auto y, auto z) { return min(x, y + 1.0) * max(y, z - 2.0); }),
      formula("pow", [](auto x, auto y, auto z) { return pow(x, -2.5) * pow(y + z, 1.5); }),
      formula("branch", [](auto x, auto y,
                           auto z) { return where_positive(x - 0.5, x * x * y, z * y) + where_positive(-x, y, z); }),
  };
}

struct RecordedFormula {
  Recording recording;
  RecordingScope scope{recording};
  Handles inputs{recording.input(), recording.input(), recording.input()};
  Recording::Handle output;

  explicit RecordedFormula(const Formula& f)
      : output(f.recorded(Recorded::of(inputs[0]), Recorded::of(inputs[1]), Recorded::of(inputs[2])).node()) {}
  Program program(const Handles& outputs) const { return {recording, inputs, outputs}; }
};

class RecordingTest : public testing::TestWithParam<Formula> {
 protected:
  /// Away from x = ½, where the branch has its jump.
  static std::array<double, 3> point(int k) {
    Random random(static_cast<std::uint64_t>(k) + 1);
    std::array<double, 3> x;
    for (double& value : x) value = 0.2 + 0.6 * random.uniform();
    if (std::abs(x[0] - 0.5) < 0.05) x[0] += 0.1;
    return x;
  }
  static double value(const std::array<double, 3>& x) { return GetParam().number(x[0], x[1], x[2]); }
};

TEST_P(RecordingTest, ProgramComputesTheFormula) {
  const RecordedFormula f(GetParam());
  const Program program = f.program({f.output});
  for (int k = 0; k < 20; ++k) {
    const auto x = point(k);
    double y;
    program.run(x.data(), &y);
    EXPECT_NEAR(y, value(x), 4e-15 * (1 + std::abs(value(x))));
  }
}

TEST_P(RecordingTest, PacksRunLaneByLane) {
  RecordedFormula f(GetParam());
  Handles outputs = f.recording.gradient(f.output, f.inputs);
  outputs.push_back(f.output);
  const Program program = f.program(outputs);
  std::array<Pack, 3> x;
  for (int lane = 0; lane < Pack::size; ++lane)
    for (int i = 0; i < 3; ++i) x[i].set(lane, point(lane)[i]);
  std::array<Pack, 4> y;
  program.run(x.data(), y.data());
  for (int lane = 0; lane < Pack::size; ++lane) {
    std::array<double, 4> expected;
    program.run(point(lane).data(), expected.data());
    for (int i = 0; i < 4; ++i) EXPECT_NEAR(y[i][lane], expected[i], 2e-14 * (1 + std::abs(expected[i])));
  }
}

TEST_P(RecordingTest, GradientIsTheLimitOfDifferences) {
  RecordedFormula f(GetParam());
  const Program program = f.program(f.recording.gradient(f.output, f.inputs));
  constexpr double h = 1e-5;
  for (int k = 0; k < 20; ++k) {
    const auto x = point(k);
    std::array<double, 3> gradient;
    program.run(x.data(), gradient.data());
    for (int i = 0; i < 3; ++i) {
      auto plus = x, minus = x;
      plus[i] += h, minus[i] -= h;
      EXPECT_NEAR(gradient[i], (value(plus) - value(minus)) / (2 * h), 1e-6) << "variable " << i << ", point " << k;
    }
  }
}

TEST_P(RecordingTest, GradientOfAGradientIsSymmetricAndTheLimitOfDifferences) {
  RecordedFormula f(GetParam());
  const Handles first = f.recording.gradient(f.output, f.inputs);
  Handles second;
  for (const auto g : first) {
    const Handles row = f.recording.gradient(g, f.inputs);
    second.insert(second.end(), row.begin(), row.end());
  }
  const Program gradient = f.program(first), hessian = f.program(second);
  constexpr double h = 1e-5;
  for (int k = 0; k < 20; ++k) {
    const auto x = point(k);
    std::array<double, 9> H;
    hessian.run(x.data(), H.data());
    for (int i = 0; i < 3; ++i) {
      auto plus = x, minus = x;
      plus[i] += h, minus[i] -= h;
      std::array<double, 3> g_plus, g_minus;
      gradient.run(plus.data(), g_plus.data());
      gradient.run(minus.data(), g_minus.data());
      for (int j = 0; j < 3; ++j) {
        EXPECT_NEAR(H[3 * i + j], (g_plus[j] - g_minus[j]) / (2 * h), 2e-5) << i << ", " << j << ", point " << k;
        EXPECT_NEAR(H[3 * i + j], H[3 * j + i], 1e-12 * (1 + std::abs(H[3 * i + j])));
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Formulas, RecordingTest, testing::ValuesIn(formulas()), [](const auto& test) {
  std::string name = test.param.name;
  std::ranges::replace(name, ' ', '_');
  return name;
});

TEST(RecordingGraphTest, RepetitionsAreRecordedOnce) {
  Recording recording;
  const RecordingScope scope(recording);
  const Recorded x = Recorded::of(recording.input()), y = Recorded::of(recording.input());
  const Recorded first = x * y + x;
  const Index size = recording.size();
  const Recorded second = x + y * x;
  EXPECT_EQ(second.node(), first.node());
  EXPECT_EQ(recording.size(), size);
}

TEST(RecordingGraphTest, ZerosAndOnesVanish) {
  Recording recording;
  const RecordingScope scope(recording);
  const Recorded x = Recorded::of(recording.input());
  EXPECT_EQ((x * 1.0 + 0.0 - 0.0).node(), x.node());
  EXPECT_EQ((0.0 - -x).node(), x.node());
  EXPECT_TRUE(recording.is_constant((x * 0.0).node()));
  EXPECT_EQ(recording[(x * 0.0).node()].value, 0);
  EXPECT_EQ((Recorded(2.0) * 3.0 + 1.0).node(), Recorded(7.0).node());
}

TEST(RecordingGraphTest, OnlyWhatIsNeededIsRun) {
  Recording recording;
  const RecordingScope scope(recording);
  const Recorded x = Recorded::of(recording.input());
  const Recorded unused = exp(x), used = x * x + x;
  (void)unused;
  const Handles inputs{x.node()}, outputs{used.node()};
  EXPECT_EQ(Program(recording, inputs, outputs).num_instructions(), 1);  // one multiply-add
}

TEST(RecordingGraphTest, WhereTheFormulaIsNotFiniteItsDerivativesAreNot) {
  Recording recording;
  const RecordingScope scope(recording);
  const Recorded x = Recorded::of(recording.input());
  const Recorded guarded = where_positive(x, x * x, Recorded(std::numeric_limits<double>::infinity()));
  const Handles inputs{x.node()};
  const Program derivative(recording, inputs, recording.gradient(guarded.node(), inputs));
  double at = 3, y;
  derivative.run(&at, &y);
  EXPECT_EQ(y, 6);
  at = -3;
  derivative.run(&at, &y);
  EXPECT_TRUE(std::isnan(y));
}

TEST(RecordingGraphTest, AProgramGoesOnInAnotherRecording) {
  Recording recording;
  const RecordingScope scope(recording);
  const Recorded x = Recorded::of(recording.input());
  const Handles inputs{x.node()}, outputs{(x * x).node()};
  const Program square(recording, inputs, outputs);
  Recorded fourth;
  const Recorded argument = x * x;
  square.run(&argument, &fourth);
  const Handles last{fourth.node()};
  double at = 1.5, y;
  Program(recording, inputs, last).run(&at, &y);
  EXPECT_DOUBLE_EQ(y, at * at * at * at);
}

TEST(RecordingGraphTest, TooManyValuesAtOnceAreRefused) {
  Recording recording;
  const RecordingScope scope(recording);
  Handles inputs, outputs;
  for (int k = 0; k < Program::max_slots + 1; ++k) inputs.push_back(recording.input());
  outputs = inputs;
  EXPECT_THROW(Program(recording, inputs, outputs), std::invalid_argument);
}

}  // namespace
}  // namespace supple::test
