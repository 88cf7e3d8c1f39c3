#include <core/check.hpp>
#include <core/random.hpp>
#include <io/text/json_fields.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

namespace supple {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using testing::StrEq;
using testing::ThrowsMessage;

constexpr const char* scene = R"({
  "name": "bar",
  "material": {"young": "200 kPa", "poisson": 0.45, "law": "neo-hookean"},
  "steps": 100,
  "damped": true,
  "gravity": [0, -9.81, 0],
  "fixed": [3, 1, 4],
  "springs": [{"node": 0, "stiffness": 5}, {"node": 2, "stiffness": "3 N/cm"}],
  "tags": ["a", "b"]
})";

/// What reading `text` says, or "" if it is accepted.
std::string refusal(const std::string& text, const std::function<void(const JsonFields&)>& read) {
  try {
    read(JsonFields::parse(text, "scene.json"));
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

void read_scene(const JsonFields& fields) {
  fields.text("name");
  const JsonFields material = fields.object("material");
  material.number("young", positive, "Pa");
  material.number("poisson", between(0, 0.5));
  material.choice("law", {"stvk", "neo-hookean"});
  fields.integer("steps", at_least(1));
  fields.flag_or("damped", false);
  fields.point("gravity", "m/s^2");
  fields.integers("fixed", non_negative);
  for (const JsonFields& spring : fields.objects("springs")) {
    spring.integer("node", non_negative);
    spring.number("stiffness", positive, "N/m");
  }
  fields.texts("tags");
  fields.finish();
}

TEST(JsonFields, ReadsEveryKindOfField) {
  const JsonFields fields = JsonFields::parse(scene, "scene.json");
  EXPECT_EQ(fields.text("name"), "bar");
  EXPECT_EQ(fields.object("material").number("young", positive, "Pa"), 2e5);
  EXPECT_EQ(fields.object("material").number("poisson", between(0, 0.5)), 0.45);
  EXPECT_EQ(fields.object("material").choice("law", {"stvk", "neo-hookean"}), "neo-hookean");
  EXPECT_EQ(fields.integer("steps", at_least(1)), 100);
  EXPECT_TRUE(fields.flag("damped"));
  EXPECT_EQ(fields.point("gravity", "m/s^2"), Point(0, -9.81, 0));
  EXPECT_THAT(fields.integers("fixed"), ElementsAre(3, 1, 4));
  EXPECT_THAT(fields.texts("tags"), ElementsAre("a", "b"));
  const std::vector<JsonFields> springs = fields.objects("springs");
  ASSERT_EQ(springs.size(), 2u);
  EXPECT_EQ(springs[1].number("stiffness", positive, "N/m"), 300);
  EXPECT_EQ(springs[1].place(), "/springs/1");
  EXPECT_EQ(springs[1].integer("node"), 2);
  EXPECT_EQ(springs[0].number("stiffness"), 5);
  EXPECT_EQ(springs[0].integer("node"), 0);
  EXPECT_NO_THROW(fields.finish());
}

TEST(JsonFields, OptionalFieldsFallBackOnlyWhenAbsent) {
  const JsonFields fields = JsonFields::parse(R"({"a": 1, "b": "text"})", "options");
  EXPECT_EQ(fields.number_or("a", 7), 1);
  EXPECT_EQ(fields.number_or("c", 7), 7);
  EXPECT_EQ(fields.integer_or("d", 3), 3);
  EXPECT_EQ(fields.text_or("b", "else"), "text");
  EXPECT_EQ(fields.choice_or("e", "x", {"x", "y"}), "x");
  EXPECT_FALSE(fields.object_if("f").has_value());
  EXPECT_TRUE(fields.objects_if("g").empty());
  EXPECT_THROW(fields.number_or("b", 7), InputError);
}

TEST(JsonFields, MessagesNameFilePlaceValueAndExpectation) {
  const auto with = [](std::string from, const std::string& to) {
    std::string text = scene;
    return refusal(text.replace(text.find(from), from.size(), to), read_scene);
  };
  EXPECT_EQ(with("\"3 N/cm\"", "-3"), "scene.json: /springs/1/stiffness is -3, expected > 0 N/m");
  EXPECT_EQ(with("0.45", "0.75"), "scene.json: /material/poisson is 0.75, expected between 0 and 0.5");
  EXPECT_EQ(with("200 kPa", "200 kg"),
            "scene.json: /material/young is \"200 kg\", expected a number in Pa: 'kg' is not a unit of Pa");
  EXPECT_EQ(with("0.45", "\"0.45\""), "scene.json: /material/poisson is \"0.45\", expected a number");
  EXPECT_EQ(with("100", "1.5"), "scene.json: /steps is 1.5, expected a whole number");
  EXPECT_EQ(with("100", "0"), "scene.json: /steps is 0, expected a whole number >= 1");
  EXPECT_EQ(with("100", "1e300"), "scene.json: /steps is 1e+300, expected a whole number");
  EXPECT_EQ(with("true", "1"), "scene.json: /damped is 1, expected true or false");
  EXPECT_EQ(with("-9.81, 0", "-9.81"), "scene.json: /gravity is a list of 2, expected a list of 3");
  EXPECT_EQ(with("-9.81", "null"), "scene.json: /gravity/1 is null, expected a number in m/s^2");
  EXPECT_EQ(with("[3, 1, 4]", "3"), "scene.json: /fixed is 3, expected a list of whole numbers");
  EXPECT_EQ(with("\"neo-hookean\"", "\"linear\""),
            "scene.json: /material/law is \"linear\", expected one of \"stvk\", \"neo-hookean\"");
  EXPECT_EQ(with("{\"node\": 0, \"stiffness\": 5}", "7"), "scene.json: /springs/0 is 7, expected an object");
  EXPECT_EQ(with("\"bar\"", "{}"), "scene.json: /name is an object, expected a text");
  EXPECT_EQ(with("\"name\": \"bar\",", ""), "scene.json: /name is missing");
  EXPECT_EQ(refusal("[1]", read_scene), "scene.json: is a list of 1, expected an object {…}");
  EXPECT_THAT([] { JsonFields::parse(scene, "s").object("material").fail("law", "needs two constants"); },
              ThrowsMessage<InputError>(StrEq("s: /material/law needs two constants")));
}

TEST(JsonFields, UnknownKeysAreRefusedWithTheNearestKnownOne) {
  const auto with = [](std::string from, const std::string& to) {
    std::string text = scene;
    return refusal(text.replace(text.find(from), from.size(), to), read_scene);
  };
  EXPECT_EQ(with("\"damped\"", "\"dampde\""), "scene.json: /dampde is not known here; did you mean \"damped\"?");
  EXPECT_EQ(with("{\"node\": 0", "{\"stifness\": 1, \"node\": 0"),
            "scene.json: /springs/0/stifness is not known here; did you mean \"stiffness\"?");
  EXPECT_EQ(with("{\"node\": 0", "{\"a/b~\": 1, \"node\": 0"), "scene.json: /springs/0/a~1b~0 is not known here");
}

TEST(JsonFields, SyntaxErrorsComeWithLineAndColumn) {
  EXPECT_THAT(refusal("{\n  \"a\": 1,\n  \"b\" 2\n}", read_scene), StartsWith("scene.json:3:7: syntax error"));
  EXPECT_THAT(refusal("{\"a\": [1, 2}", read_scene), StartsWith("scene.json:1:12: syntax error"));
  EXPECT_THAT(refusal("", read_scene), StartsWith("scene.json:1:1: syntax error"));
  EXPECT_EQ(refusal("{\n\"a\": 1e999}", read_scene), "scene.json:2:6: the number 1e999 is too large");
  EXPECT_EQ(refusal("{\"a\": {\"b\": 1, \"b\": 2}}", read_scene),
            "scene.json: the key \"b\" appears twice in one object");
  EXPECT_EQ(refusal(std::string("{}\0x", 4), read_scene), "scene.json:1:3: a NUL byte, expected text");
  EXPECT_NE(refusal("{\"a\": \"\xff\"}", read_scene), "");
  EXPECT_THAT([] { JsonFields::read("/nowhere/scene.json"); },
              ThrowsMessage<InputError>(StrEq("/nowhere/scene.json: cannot be read: No such file or directory")));
  EXPECT_THAT([] { JsonFields::read("/tmp"); }, ThrowsMessage<InputError>(StartsWith("/tmp: cannot be read")));
}

TEST(JsonFields, VeryDeepNestingIsAnErrorNotACrash) {
  const std::string deep = "{\"name\": " + std::string(200000, '[') + std::string(200000, ']') + "}";
  EXPECT_EQ(refusal(deep, read_scene), "scene.json: /name is a list of 1, expected a text");
}

TEST(JsonFields, SeededMutationsAreReadOrRefusedAndNeverCrash) {
  const std::string text = scene;
  constexpr std::string_view pieces[] = {"{",     "}", "[",     "]",    ":",    ",",   "\"",
                                         "\\u12", "-", "1e400", "null", "\xc3", "true"};
  Random random(11);
  int refused = 0;
  constexpr int rounds = 20000;
  for (int round = 0; round < rounds; ++round) {
    std::string changed = text;
    for (Index edits = 1 + random.below(3); edits > 0; --edits) {
      const auto at = static_cast<std::size_t>(random.below(static_cast<Index>(changed.size())));
      switch (random.below(3)) {
        case 0:
          changed[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          changed.erase(at, static_cast<std::size_t>(1 + random.below(8)));
          break;
        default:
          changed.insert(at, pieces[random.below(std::size(pieces))]);
      }
    }
    const std::string message = refusal(changed, read_scene);
    refused += message != "";
    if (message != "") {
      ASSERT_THAT(message, StartsWith("scene.json:")) << changed;
    }
  }
  EXPECT_GT(refused, rounds / 2);
  EXPECT_LT(refused, rounds);
}

TEST(NearestWord, CountsSwapsAsOneStepAndKeepsItsDistance) {
  const std::vector<std::string> known{"stiffness", "node", "damping"};
  EXPECT_EQ(nearest_word("stiffnses", known), "stiffness");
  EXPECT_EQ(nearest_word("nod", known), "node");
  EXPECT_EQ(nearest_word("mass", known), std::nullopt);
  EXPECT_EQ(nearest_word("", known), std::nullopt);
}

}  // namespace
}  // namespace supple
