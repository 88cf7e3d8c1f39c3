#include <core/check.hpp>
#include <core/random.hpp>
#include <io/table/csv.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <clocale>
#include <fstream>
#include <iterator>
#include <limits>
#include <unistd.h>

namespace supple {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Csv : testing::Test {
  ~Csv() override { fs::remove(path); }

  CsvTable parse(const std::string& text) const {
    std::ofstream(path, std::ios::binary) << text;
    return read_csv(path);
  }
  auto refusal(const std::string& expected) const {
    return ThrowsMessage<InputError>(AllOf(HasSubstr(path.string()), HasSubstr(expected)));
  }

  const fs::path path = fs::temp_directory_path() / ("supple-table-" + std::to_string(::getpid()) + ".csv");
};

TEST_F(Csv, WritesTheHeaderWithUnitsAndOneLineARow) {
  CsvTable table{{"time", "s"}, {"energy", "J"}, {"status"}};
  table.add_row(0.1, -2.5e-300, "converged");
  table.add_row(1, 3, std::string("say \"no\", or\nnot"));
  write_csv(path, table);
  std::ifstream file(path, std::ios::binary);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(file), {}),
            "time [s],energy [J],status\n0.1,-2.5e-300,converged\n1,3,\"say \"\"no\"\", or\nnot\"\n");
}

TEST_F(Csv, ReadsBackEveryBitWhateverTheLocale) {
  const char* before = std::setlocale(LC_ALL, nullptr);
  const std::string kept = before;
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // a decimal comma, where that locale is installed
  using Limits = std::numeric_limits<double>;
  Random random(9);
  Vector values = Vector::NullaryExpr(
      200, [&](Index) { return std::ldexp(random.normal(), static_cast<int>(random.below(600)) - 300); });
  values.head<5>() << 0.1, Limits::max(), Limits::denorm_min(), -Limits::infinity(), -0.0;
  CsvTable table{{"x", "m"}};
  for (const double value : values) table.add_row(value);
  write_csv(path, table);
  const CsvTable read = read_csv(path);
  std::setlocale(LC_ALL, kept.c_str());
  EXPECT_EQ(read.numbers("x"), values);
  EXPECT_TRUE(std::signbit(read.numbers("x")[4]));
  EXPECT_EQ(read.columns().front().unit, "m");
}

TEST_F(Csv, TextOfAnyKindSurvives) {
  const std::vector<std::string> texts{"", " padded ", "a,b", "\"", "line\r\nbreak", "Größe"};
  CsvTable table{{"a, \"b\"", "kg m^2"}, {"n"}};
  for (const std::string& text : texts) table.add_row(text, 1);
  write_csv(path, table);
  const CsvTable read = read_csv(path);
  EXPECT_EQ(read.texts("a, \"b\""), texts);
  EXPECT_EQ(read.columns()[0].unit, "kg m^2");
}

TEST_F(Csv, ReadsTablesOfOtherPrograms) {
  const CsvTable table = parse("\xef\xbb\xbftime [s],\"u\"\r\n0,1\r\n0.5,\"2\"\r\n1,nan");
  EXPECT_THAT(table.numbers("time"), ElementsAre(0, 0.5, 1));
  EXPECT_THAT(table.numbers("u").head(2), ElementsAre(1, 2));
  EXPECT_TRUE(std::isnan(table.numbers("u")[2]));
}

TEST_F(Csv, ErrorsNameFileLineAndExpectation) {
  EXPECT_THAT([&] { parse("a,b\n1,2\n\"x\ny\",2\n3\n"); }, refusal(":5: has 1 cells, expected 2"));
  EXPECT_THAT([&] { parse("a,b\n\"1,2\n"); }, refusal(":3: expected a closing quotation mark"));
  EXPECT_THAT([&] { parse("a,b\n\"1\"2,3\n"); }, refusal(":2: expected ',' or the end of the line"));
  EXPECT_THAT([&] { parse("a,a\n"); }, refusal(":1: two columns have the name 'a'"));
  EXPECT_THAT([&] { parse(""); }, refusal("is empty, expected a header"));
  EXPECT_THAT([&] { parse("a [m],b\n1,2\n3,four\n").numbers("b"); }, refusal(":3: 'b' is 'four', expected a number"));
  EXPECT_THAT([&] { parse("a [m],b\n").numbers("c"); }, refusal("expected a column 'c'; there are 'a', 'b'"));
  EXPECT_THAT([&] { read_csv(path / "none"); }, ThrowsMessage<InputError>(HasSubstr("cannot be read")));
  EXPECT_THROW(CsvTable(std::vector<CsvTable::Column>()), std::invalid_argument);
  CsvTable table{{"a"}, {"b"}};
  EXPECT_THROW(table.add_row(1), std::invalid_argument);
}

}  // namespace
}  // namespace supple
