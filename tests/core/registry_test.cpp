#include <core/registry.hpp>

#include <gmock/gmock.h>

#include <limits>
#include <thread>

namespace supple {

enum class Colour { Red, Green };
template <>
inline constexpr std::array names_of<Colour>{Named{Colour::Red, "red"}, Named{Colour::Green, "green"}};

namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

struct Brush {
  Index width = 3;
  std::uint64_t seed = 0;
  double pressure = 0.25;
  bool wet = true;
  std::string hair = "hog";
  Colour colour = Colour::Green;
};

OptionsOf<Brush> brush_options() {
  return OptionsOf<Brush>()
      .add("width", &Brush::width, "in hairs")
      .add("seed", &Brush::seed, "of the strokes")
      .add("pressure", &Brush::pressure, "[N]")
      .add("wet", &Brush::wet, "or dry")
      .add("hair", &Brush::hair, "of which animal")
      .add("colour", &Brush::colour, "one of " + listed(all_names_of<Colour>()));
}

TEST(NamesOf, GoBothWays) {
  EXPECT_EQ(name_of(Colour::Red), "red");
  EXPECT_EQ(value_named<Colour>("green", "colour"), Colour::Green);
  EXPECT_THAT([] { (void)value_named<Colour>("blue", "colour"); },
              ThrowsMessage<std::invalid_argument>("colour 'blue' is not known, expected one of red, green"));
}

TEST(Choice, SplitsANameFromItsOptions) {
  EXPECT_EQ(Choice::parse("greedy").name, "greedy");
  const Choice choice = Choice::parse("greedy:candidates=12:note=a=b");
  EXPECT_EQ(choice.name, "greedy");
  EXPECT_THAT(choice.options, ElementsAre(std::pair<std::string, std::string>("candidates", "12"),
                                          std::pair<std::string, std::string>("note", "a=b")));
  for (const char* wrong : {"greedy:", "greedy:12", "greedy:=12", "greedy:a=1:a=2"})
    EXPECT_THAT([&] { (void)Choice::parse(wrong); }, ThrowsMessage<std::invalid_argument>(HasSubstr(wrong))) << wrong;
}

TEST(OptionsOf, TellDefaultsAndReplaceThem) {
  const OptionsOf<Brush> options = brush_options();
  const std::vector<OptionInfo> info = options.info();
  ASSERT_EQ(info.size(), 6u);
  EXPECT_EQ(info[0].default_value, "3");
  EXPECT_EQ(info[2].default_value, "0.25");
  EXPECT_EQ(info[3].default_value, "yes");
  EXPECT_EQ(info[5].default_value, "green");
  EXPECT_EQ(info[0].type, OptionType::WholeNumber);
  EXPECT_EQ(info[2].type, OptionType::Number);
  EXPECT_EQ(info[3].type, OptionType::Flag);
  EXPECT_EQ(info[5].type, OptionType::Word);

  const Brush brush = options.make({{"width", "7"}, {"pressure", "1e-3"}, {"wet", "no"}, {"colour", "red"}}, "brush");
  EXPECT_EQ(brush.width, 7);
  EXPECT_EQ(brush.pressure, 1e-3);
  EXPECT_FALSE(brush.wet);
  EXPECT_EQ(brush.colour, Colour::Red);
  EXPECT_EQ(brush.hair, "hog") << "as it was";
  EXPECT_EQ(options.make({{"pressure", "inf"}}, "brush").pressure, std::numeric_limits<double>::infinity());
}

TEST(OptionsOf, WhatTheyTellMakesTheDefaultsAgain) {
  const OptionsOf<Brush> options = brush_options();
  OptionValues told;
  for (const OptionInfo& option : options.info()) told.emplace_back(option.name, option.default_value);
  const Brush brush = options.make(told, "brush"), expected;
  EXPECT_EQ(brush.width, expected.width);
  EXPECT_EQ(brush.pressure, expected.pressure);
  EXPECT_EQ(brush.wet, expected.wet);
  EXPECT_EQ(brush.colour, expected.colour);
}

TEST(OptionsOf, RefuseWhatTheyDoNotKnow) {
  const auto refused = [](const char* name, const char* value, const auto& reason) {
    EXPECT_THAT(
        [&] {
          (void)brush_options().make({{name, value}}, "brush oil");
        },
        ThrowsMessage<std::invalid_argument>(AllOf(HasSubstr("brush oil"), HasSubstr(name), reason)));
  };
  refused("length", "3", HasSubstr("expected one of width, seed, pressure, wet, hair, colour"));
  refused("width", "3.5", HasSubstr("'3.5', expected a whole number"));
  refused("width", "", HasSubstr("expected a whole number"));
  refused("seed", "-1", HasSubstr("expected a whole number"));
  refused("pressure", "high", HasSubstr("'high', expected a number"));
  refused("pressure", "nan", HasSubstr("expected a number"));
  refused("wet", "maybe", HasSubstr("expected yes or no"));
  refused("colour", "blue", HasSubstr("red, green"));
}

TEST(OptionsOf, RefuseNamesThatNobodyCanWrite) {
  for (const char* name : {"", "a b", "a:b", "a=b", "a+b", "width"})
    EXPECT_THAT([&] { brush_options().add(name, &Brush::width, ""); },
                ThrowsMessage<std::invalid_argument>(HasSubstr("'" + std::string(name) + "'")));
}

struct Entry {
  std::string name, description;
  std::vector<OptionInfo> options = {};
};

TEST(Registry, FindsWhatWasAddedAndKeepsReferences) {
  Registry<Entry> tools("tool", {{"brush", "paints"}, {"pen", "writes"}}, ", or make one");
  const Entry& brush = tools.at("brush");
  for (int k = 0; k < 100; ++k) tools.add({"tool-" + std::to_string(k), ""});
  EXPECT_EQ(&tools.at("brush"), &brush);
  EXPECT_EQ(tools.names().front(), "brush");
  EXPECT_EQ(tools.names().size(), 102u);
  EXPECT_TRUE(tools.contains("tool-99"));
  EXPECT_FALSE(tools.contains("saw"));
  EXPECT_THAT(
      [&] {
        tools.add({"pen", "again"});
      },
      ThrowsMessage<std::invalid_argument>("there is a tool 'pen' already"));
  for (const char* name : {"", "a b", "a:b", "a=b", "a+b", "a\n"})
    EXPECT_THAT(
        [&] {
          tools.add({name, "no choice"});
        },
        ThrowsMessage<std::invalid_argument>(HasSubstr("expected letters, digits, '-', '_' and '.'")));
  EXPECT_THAT([&] { (void)tools.at("saw"); },
              ThrowsMessage<std::invalid_argument>(
                  AllOf(HasSubstr("tool 'saw' is not known"), HasSubstr("brush, pen"), HasSubstr(", or make one"))));
}

TEST(Registry, MayBeUsedFromSeveralThreads) {
  Registry<Entry> tools("tool", {{"brush", "paints"}});
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&tools, t] {
      for (int k = 0; k < 50; ++k) {
        tools.add({std::to_string(t) + "-" + std::to_string(k), ""});
        EXPECT_EQ(tools.at("brush").description, "paints");
      }
    });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(tools.names().size(), 201u);
}

TEST(Registry, DescribesItselfForAHelp) {
  const Registry<Entry> tools("tool", {{"brush", "paints", brush_options().info()}});
  EXPECT_THAT(described(tools), AllOf(HasSubstr("  brush: paints\n"), HasSubstr("      width=3: in hairs\n")));
}

}  // namespace
}  // namespace supple
