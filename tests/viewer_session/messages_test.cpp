#include <tests/viewer_session/bad_messages.hpp>
#include <tests/viewer_session/small_view_model.hpp>
#include <viewer/server/guard.hpp>
#include <viewer/server/hub.hpp>

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

#include <chrono>
#include <cmath>
#include <cstring>

namespace supple::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(MessagesTest, ReadsEachRequest) {
  const auto model = clamped_view_model();
  for (const std::string& text : good_messages()) {
    const ReadMessage read = read_message(text, *model);
    EXPECT_EQ(read.what_to_do, json::parse(text).at("do")) << text;
  }
  const auto set = read_message(
      R"({"do": "set", "gravity": [0, -9.81, 0], "floor": null, "damping": {"mass": 1, "stiffness": 0}})", *model);
  const SettingsChange& change = std::get<request::Set>(std::get<Request>(set.message)).change;
  EXPECT_EQ((*change.gravity)[1], -9.81);
  EXPECT_TRUE(change.floor.has_value() && !change.floor->has_value());
  EXPECT_EQ(change.damping->alpha, 1);
  EXPECT_FALSE(change.step.has_value());
}

TEST(MessagesTest, RefusesWithAReasonThatNamesThePlace) {
  const auto model = clamped_view_model();
  for (const auto& [text, reason] : bad_messages()) {
    try {
      (void)read_message(text, *model);
      ADD_FAILURE() << text;
    } catch (const Refusal& refusal) {
      EXPECT_THAT(refusal.what(), HasSubstr(reason)) << text;
    }
  }
}

TEST(MessagesTest, RefusesMoreNodesThanThereAre) {
  const auto model = clamped_view_model();
  const auto fix = [&](Index count) {
    return read_message(json{{"do", "fix"}, {"nodes", std::vector<Index>(count, 0)}}.dump(), *model);
  };
  EXPECT_NO_THROW((void)fix(model->geometry.num_nodes()));
  EXPECT_THROW((void)fix(model->geometry.num_nodes() + 1), Refusal);
}

TEST(MessagesTest, RefusesMoreForcesThanHandlesBeforeItReadsThem) {
  const auto model = clamped_view_model();
  const auto load = [&](std::size_t count) {
    const json force{{"nodes", "x>50%"}, {"force", {0, 0, 1}}};
    return read_message(json{{"do", "load"},
                             {"scene",
                              {{"handles", json::array({json{{"name", "a"}, {"nodes", "x>90%"}}})},
                               {"forces", std::vector<json>(count, force)},
                               {"edits", json::array({json{{"moves", json::array()}}})}}}}
                            .dump(),
                        *model);
  };
  EXPECT_NO_THROW((void)load(EditSession::most_handles));
  EXPECT_THROW((void)load(EditSession::most_handles + 1), Refusal);
}

TEST(MessagesTest, TellsRefusedMessagesFromNone) {
  const auto model = clamped_view_model();
  for (const std::string& text :
       {std::string(), std::string("{"), std::string("play"), std::string("{\"do\": NaN}"), std::string("\xff\xfe"),
        std::string(1000, '['), std::string(largest_message + 1, ' ')})
    EXPECT_THROW((void)read_message(text, *model), NoMessage) << text.substr(0, 40);
  // deep, and sound: nobody's stack ends there
  const std::string deep = "{\"do\": " + std::string(400000, '[') + std::string(400000, ']') + "}";
  EXPECT_THROW((void)read_message(deep, *model), Refusal);
  EXPECT_THROW((void)read_message("{\"do\": \"play\", \"do\": \"pause\"}", *model), Refusal);
  EXPECT_THROW((void)read_message("{\"do\": \"set\", \"step\": 1e999}", *model), Refusal);
}

TEST(MessagesTest, FramesHoldTheirNumbersWhereTheProtocolSays) {
  const auto model = clamped_view_model();
  ViewFrame frame{.time = 1.5,
                  .kinetic = 2,
                  .elastic = 3,
                  .potential = 4,
                  .made = -5,
                  .residual = 1e-7,
                  .iterations = 6,
                  .seconds = 7e-6,
                  .steps_per_second = 8,
                  .speed = 0.5,
                  .error = NAN,
                  .playing = true,
                  .falls_behind = false,
                  .missed = true,
                  .beyond_training = true,
                  .num_steps = 9};
  frame.q = 0.01 * model->mode(0);
  const std::string bytes = frame_bytes(frame, 17, StreamKind::Coordinates, model->geometry);
  ASSERT_EQ(bytes.size(), 96 + 4 * static_cast<std::size_t>(model->dim()));
  const auto at = [&]<typename T>(std::size_t offset, T) {
    T value;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
  };
  const auto whole = [&](std::size_t offset) { return at(offset, std::uint32_t{}); };
  EXPECT_EQ(whole(0), 1u);
  EXPECT_EQ(whole(4), 17u);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(at(8 + 8 * static_cast<std::size_t>(k), double{}), k == 0 ? 1.5 : k + 1);
  EXPECT_EQ(at(40, double{}), -5);
  EXPECT_EQ(at(48, float{}), 1e-7f);
  EXPECT_EQ(whole(52), 6u);
  EXPECT_FLOAT_EQ(at(56, float{}), 7);
  EXPECT_EQ(at(60, float{}), 8);
  EXPECT_EQ(at(64, float{}), 0.5);
  EXPECT_TRUE(std::isnan(at(68, float{})));
  EXPECT_EQ(whole(72), 1u | 4u | 8u);
  EXPECT_EQ(whole(76), static_cast<std::uint32_t>(model->dim()));
  EXPECT_EQ(whole(80), 9u);
  EXPECT_EQ(at(96, float{}), static_cast<float>(frame.q[0]));
  EXPECT_EQ(frame_bytes(frame, 17, StreamKind::Positions, model->geometry).size(),
            96 + 12 * static_cast<std::size_t>(model->geometry.num_surface_nodes));
}

TEST(ModelResourcesTest, AreOfTheSizesThatTheDescriptionTells) {
  const auto model = clamped_view_model();
  const Resources resources = model_resources(*model);
  const json about = json::parse(resources.at("/model.json").bytes);
  const auto size = [&](const char* name) { return resources.at("/model/" + std::string(name) + ".bin").bytes.size(); };
  const auto count = [&](const char* key) { return about.at(key).get<std::size_t>(); };
  EXPECT_EQ(size("positions"), 12 * count("nodes"));
  EXPECT_EQ(size("triangles"), 12 * count("triangles"));
  EXPECT_EQ(size("basis"), 4 * count("nodes") * count("fields") * (count("block") == 1 ? 3 : 1));
  EXPECT_EQ(size("nodes"), 4 * count("nodes"));
  EXPECT_EQ(size("components"), 4 * count("components") * count("component_nodes"));
  EXPECT_EQ(size("weights"), 4 * count("components"));
  EXPECT_EQ(size("modes"), 4 * about.at("frequencies").size() * count("dimension"));
  for (const char* key : {"name", "solid", "low", "high", "diagonal", "mass", "fixed", "indicator", "step",
                          "pull_stiffness", "handle_stiffness", "integrators", "full_error", "notes", "protocol"})
    EXPECT_TRUE(about.contains(key)) << key;
}

TEST(GuardTest, KnowsItsNamesAndNoOthers) {
  const Guard guard;
  for (const char* host : {"127.0.0.1", "127.0.0.1:80", "localhost:9000", "[::1]:1", "localhost"})
    EXPECT_TRUE(guard.allows_host(host, "127.0.0.1")) << host;
  for (const char* host : {"", "evil.example", "127.0.0.1.evil.example", "localhost.evil.example:80", "10.0.0.7", "["})
    EXPECT_FALSE(guard.allows_host(host, "127.0.0.1")) << host;
  EXPECT_TRUE(guard.allows_host("10.0.0.7:80", "10.0.0.7"));
  EXPECT_FALSE(guard.allows_host("localhost", "10.0.0.7"));
  EXPECT_TRUE((Guard{.token = "", .machine = "Ada"}.allows_host("aDa:80", "10.0.0.7")));
  EXPECT_TRUE(guard.allows_host("LocalHost:80", "127.0.0.1"));
}

TEST(GuardTest, LetsInPagesOfItsOwnOriginAndThoseThatAreNoPages) {
  const Guard guard;
  EXPECT_TRUE(guard.allows_origin(std::nullopt, "localhost:80"));
  EXPECT_TRUE(guard.allows_origin("http://localhost:80", "localhost:80"));
  for (const char* origin : {"http://localhost:81", "https://localhost:80", "null", "", "http://evil.example"})
    EXPECT_FALSE(guard.allows_origin(origin, "localhost:80")) << origin;
}

TEST(GuardTest, AsksForItsToken) {
  const Guard guard{.token = "0123abcd", .machine = "", .cookie = "supple-80"};
  EXPECT_TRUE(guard.allows_token("token=0123abcd", ""));
  EXPECT_TRUE(guard.allows_token("a=b&token=0123abcd", ""));
  EXPECT_TRUE(guard.allows_token("", "x=y; supple-80=0123abcd"));
  for (const char* query : {"", "token", "token=", "token=0123abce", "token=0123abcd0", "tokens=0123abcd", "0123abcd"})
    EXPECT_FALSE(guard.allows_token(query, "supple-81=0123abcd")) << query;
  EXPECT_TRUE(Guard{}.allows_token("", ""));
  EXPECT_NE(random_token(), random_token());
  EXPECT_EQ(random_token().size(), 32u);
}

/// A hub, and what it says, without a network.
struct Talk {
  Hub hub{[] {}};

  explicit Talk(const std::shared_ptr<const ViewModel>& model) {
    if (model) hub.serve(model);
  }
  /// The next text of a kind; frames are acknowledged.
  json await(int client, const char* say) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
    while (std::chrono::steady_clock::now() < end) {
      const auto next = hub.next(client);
      if (!next) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      } else if (next->is_frame) {
        std::uint32_t number;
        std::memcpy(&number, next->bytes->data() + 4, sizeof number);
        hub.receive(client, json{{"do", "ack"}, {"frame", number}}.dump());
      } else if (json text = json::parse(*next->bytes); text.at("say") == say) {
        return text;
      }
    }
    return {};
  }
  json state_after(int client, const char* message) {
    hub.receive(client, message);
    return await(client, "state");
  }
};

TEST(HubTest, RefusedMessagesLeaveTheStateAsItIs) {
  Talk talk(clamped_view_model());
  const int client = talk.hub.connect();
  EXPECT_EQ(talk.await(client, "hello").at("client"), client);
  EXPECT_FALSE(talk.await(client, "ready").is_null());
  EXPECT_FALSE(talk.await(client, "state").is_null());
  talk.state_after(client, R"({"do": "handle", "nodes": [50, 51], "name": "one"})");
  const json before = talk.state_after(client, R"({"do": "pause"})");
  std::vector<std::string> refused;
  for (const auto& [text, reason] : bad_messages()) refused.push_back(text);
  for (const std::string& text : messages_that_sessions_refuse()) refused.push_back(text);
  for (const std::string& text : refused) {
    EXPECT_TRUE(talk.hub.receive(client, text)) << text;
    const json answer = talk.await(client, "refused");
    ASSERT_FALSE(answer.is_null()) << text;
    EXPECT_NE(answer.at("reason"), "") << text;
  }
  EXPECT_EQ(talk.state_after(client, R"({"do": "pause"})"), before);
}

TEST(HubTest, SavesWhatItLoads) {
  Talk talk(clamped_view_model());
  const int client = talk.hub.connect();
  talk.hub.receive(client, R"({"do": "mode", "mode": "edit"})");
  talk.hub.receive(client, R"({"do": "handle", "nodes": [50, 51, 52], "name": "hand"})");
  talk.hub.receive(client, R"({"do": "move", "handle": 1, "motion": [1, 0, 0, 0, 0, 1, 0, 0.02, 0, 0, 1, 0]})");
  talk.hub.receive(client, R"({"do": "save"})");
  const json scene = talk.await(client, "saved").at("scene");
  talk.hub.receive(client, R"({"do": "remove", "handle": 1})");
  talk.hub.receive(client, json{{"do", "load"}, {"scene", scene}}.dump());
  talk.hub.receive(client, R"({"do": "save"})");
  EXPECT_EQ(talk.await(client, "saved").at("scene"), scene);
}

TEST(HubTest, AnswersNobodyBeforeThereIsAModelButTellsHowFarItIs) {
  Talk talk(nullptr);
  talk.hub.progress("modes", 0.25);
  const int client = talk.hub.connect();
  EXPECT_EQ(talk.await(client, "progress").at("share"), 0.25);
  EXPECT_EQ(talk.hub.resources(), nullptr);
  EXPECT_TRUE(talk.hub.receive(client, R"({"do": "play"})"));
  EXPECT_THAT(talk.await(client, "refused").at("reason").get<std::string>(), HasSubstr("not ready"));
  talk.hub.serve(clamped_view_model());
  EXPECT_FALSE(talk.await(client, "ready").is_null());
  EXPECT_FALSE(talk.await(client, "state").is_null());
}

}  // namespace

}  // namespace supple::test
