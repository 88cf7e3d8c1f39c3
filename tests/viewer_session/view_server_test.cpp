#include <core/check.hpp>
#include <core/random.hpp>
#include <core/stopwatch.hpp>
#include <tests/support/long_run.hpp>
#include <tests/support/test_folder.hpp>
#include <tests/viewer_session/bad_messages.hpp>
#include <tests/viewer_session/small_view_model.hpp>
#include <tests/viewer_session/web_client.hpp>
#include <viewer/server/view_server.hpp>

#include <gmock/gmock.h>

#include <cstring>
#include <fstream>

namespace supple::test {

namespace {

using nlohmann::json;
using testing::HasSubstr;

/// The small clamped bar, served with a page of two files, and a third that is called as the model is.
class ViewServerTest : public testing::Test {
 protected:
  static Resources page() {
    return {{"/", {"text/html", "<html>"}},
            {"/index.html", {"text/html", "<html>"}},
            {"/assets/page.js", {"text/javascript", "go()"}},
            {"/model.json", {"application/json", "of the page"}}};
  }
  ViewServerTest() { server.serve(clamped_view_model()); }

  std::uint16_t port() const { return server.port(); }
  std::string own_host() const { return "127.0.0.1:" + std::to_string(port()); }

  ViewServer server{{.address = "127.0.0.1", .port = 0, .page = page()}};
};

TEST_F(ViewServerTest, ServesThePageByExactNamesAlone) {
  EXPECT_EQ(server.url(), "http://" + own_host() + "/");
  const HttpAnswer index = get(port(), "/");
  EXPECT_EQ(index.status, 200);
  EXPECT_EQ(index.body, "<html>");
  EXPECT_TRUE(index.has("Content-Type: text/html"));
  EXPECT_TRUE(index.has("nosniff"));
  EXPECT_EQ(get(port(), "/assets/page.js?v=3").body, "go()");
  for (const char* path : {"/assets/", "/assets", "/../etc/passwd", "/assets/../index.html", "/%2e%2e/etc/passwd",
                           "/assets/%2e%2e/index.html", "//index.html", "/index.html/", "/etc/passwd", "/model/",
                           "/model/../model.json", "http://evil.example/", "*"})
    EXPECT_THAT(get(port(), path).status, testing::AnyOf(400, 404)) << path;
}

TEST_F(ViewServerTest, AnswersGetAndHeadWithoutBodiesAlone) {
  const std::string rest = " / HTTP/1.1\r\nHost: " + own_host() + "\r\nConnection: close\r\n";
  const HttpAnswer head = ask(port(), "HEAD" + rest + "\r\n");
  EXPECT_EQ(head.status, 200);
  EXPECT_EQ(head.body, "");
  EXPECT_TRUE(head.has("Content-Length: 6"));
  for (const char* method : {"POST", "PUT", "DELETE", "OPTIONS", "TRACE"})
    EXPECT_EQ(ask(port(), method + rest + "\r\n").status, 405) << method;
  EXPECT_EQ(ask(port(), "POST" + rest + "Content-Length: 10\r\n\r\n0123456789").status, 413);
  EXPECT_EQ(ask(port(), "GET" + rest + "X: " + std::string(100000, 'x') + "\r\n\r\n").status, 431);
  EXPECT_EQ(ask(port(), "nonsense\r\n\r\n").status, 400);
  EXPECT_EQ(get(port(), "/").status, 200);
}

TEST_F(ViewServerTest, SendsTheModelAsItIsDescribed) {
  const json about = json::parse(get(port(), "/model.json").body);
  EXPECT_EQ(about.at("name"), "bar");
  const std::string positions = get(port(), "/model/positions.bin").body;
  ASSERT_EQ(positions.size(), 12 * about.at("nodes").get<std::size_t>());
  const ViewGeometry& geometry = clamped_view_model()->geometry;
  for (Index k = 0; k < geometry.num_nodes(); ++k)
    for (Index x = 0; x < 3; ++x) {
      float value;
      std::memcpy(&value, positions.data() + 12 * k + 4 * x, sizeof value);
      EXPECT_EQ(value, static_cast<float>(geometry.rest(k, x)));
    }
}

TEST_F(ViewServerTest, AnswersByItsOwnNamesAlone) {
  for (const char* host : {"evil.example", "evil.example:80", "127.0.0.1.evil.example", "10.1.2.3"})
    for (const char* target : {"/", "/model.json", "/session"})
      EXPECT_EQ(
          ask(port(), "GET " + std::string(target) + " HTTP/1.1\r\nHost: " + host + "\r\nConnection: close\r\n\r\n")
              .status,
          403)
          << host << target;
  EXPECT_EQ(ask(port(), "GET / HTTP/1.1\r\nConnection: close\r\n\r\n").status, 403);
  EXPECT_EQ(ask(port(), "GET / HTTP/1.1\r\nHost: localhost:9999\r\nConnection: close\r\n\r\n").status,
            200);  // a tunnel
  EXPECT_THROW(WebClient(port(), {.target = "/session", .host = "evil.example", .origin = ""}), std::runtime_error);
}

TEST_F(ViewServerTest, OpensSocketsToPagesOfItsOriginAndToProgramsAlone) {
  const auto open = [&](std::string host, std::string origin) {
    return WebClient(port(), {.target = "/session", .host = std::move(host), .origin = std::move(origin)});
  };
  EXPECT_FALSE(open("", "http://" + own_host()).await("hello").is_null());
  EXPECT_FALSE(open("localhost:9000", "http://localhost:9000").await("hello").is_null());
  EXPECT_FALSE(open("", "").await("hello").is_null());
  for (const char* origin : {"http://evil.example", "null", "https://127.0.0.1"})
    EXPECT_THROW(open("", origin), std::runtime_error) << origin;
  EXPECT_EQ(get(port(), "/model.json", "Origin: http://evil.example\r\n").status, 403);
  EXPECT_EQ(get(port(), "/session").status, 426);
}

TEST(ViewServerTokenTest, IsAskedForBeyondTheLoopbackInterface) {
  ViewServer server({.address = "0.0.0.0", .port = 0, .page = {{"/", {"text/html", "<html>"}}}});
  server.serve(clamped_view_model());
  ASSERT_EQ(server.token().size(), 32u);
  EXPECT_THAT(server.url(), HasSubstr("?token=" + server.token()));
  const std::uint16_t port = server.port();
  for (const char* target :
       {"/", "/model.json", "/model/basis.bin", "/?token=", "/?token=0123456789abcdef0123456789abcdef"})
    EXPECT_EQ(get(port, target).status, 401) << target;
  EXPECT_THROW(WebClient{port}, std::runtime_error);
  const HttpAnswer page = get(port, "/?token=" + server.token());
  EXPECT_EQ(page.status, 200);
  const std::string cookie = "supple-" + std::to_string(port) + "=" + server.token();
  EXPECT_TRUE(page.has("Set-Cookie: " + cookie + "; HttpOnly; SameSite=Strict"));
  EXPECT_EQ(get(port, "/model.json", "Cookie: " + cookie + "\r\n").status, 200);
  WebClient client(port, {.target = "/session?token=" + server.token(), .host = "", .origin = ""});
  EXPECT_FALSE(client.await("hello").is_null());
}

TEST_F(ViewServerTest, ClosesOnWhatIsNoMessageOrTooLong) {
  for (const std::string& text : {std::string("{"), std::string((1 << 20) + 1, ' ')}) {
    WebClient client(port());
    client.await("state");
    client.send(std::string_view(text));
    EXPECT_TRUE(client.await("refused").is_null());
    EXPECT_TRUE(client.closed());
    EXPECT_THAT(client.close_code(), testing::AnyOf(1007, 1009, 0)) << text.size();
  }
  WebClient client(port());
  client.await("state");
  client.send_binary("play");
  EXPECT_THAT(client.await("refused").at("reason").get<std::string>(), HasSubstr("binary"));
  client.send(std::string_view(R"({"do": "play", "pad": ")" + std::string((1 << 20) - 100, 'x') + "\"}"));
  EXPECT_EQ(client.await("refused").at("do"), "play");
}

TEST_F(ViewServerTest, TellsWhoComesWhenThereIsNoPlaceLeft) {
  {
    std::vector<WebClient> clients;
    for (int k = 0; k < 128; ++k) clients.emplace_back(port());
    EXPECT_EQ(get(port(), "/").status, 503);
    EXPECT_FALSE(clients.front().await("hello").is_null());
  }
  const Stopwatch watch;
  while (get(port(), "/").status != 200 && watch.seconds() < 10) continue;
  EXPECT_EQ(get(port(), "/").status, 200);
}

TEST_F(ViewServerTest, TwoClientsShareASession) {
  WebClient one(port()), other(port());
  const int first = one.await("hello").at("client"), second = other.await("hello").at("client");
  EXPECT_NE(first, second);
  one.await("state");
  other.await("state");
  const json tip = surface_node_near(*clamped_view_model(), clamped_view_model()->box.upper);
  one.send(json{{"do", "pull"}, {"node", tip}, {"target", {1, 1, 0}}});
  json pulls = other.await("state").at("pulls");
  ASSERT_EQ(pulls.size(), 1u);
  EXPECT_EQ(pulls[0].at("client"), first);
  other.send(json{{"do", "pull"}, {"node", tip}, {"target", {1, 0, 1}}});
  while (pulls.size() != 2) pulls = one.await("state").at("pulls");
  { WebClient leaving = std::move(one); }
  while (pulls.size() != 1) pulls = other.await("state").at("pulls");
  EXPECT_EQ(pulls[0].at("client"), second);
}

TEST_F(ViewServerTest, AClientThatAcknowledgesNothingGetsOneFrameAndStallsNobody) {
  WebClient silent(port()), busy(port());
  ASSERT_TRUE(silent.await_frame().has_value());
  busy.send(json{{"do", "play"}});
  double time = 0;
  int frames = 0;
  std::uint32_t number = 0;
  while (time < 0.5) {
    const auto frame = busy.await_frame();
    ASSERT_TRUE(frame.has_value());
    EXPECT_GT(frame->frame_number(), number);
    number = frame->frame_number();
    time = frame->time();
    ++frames;
    busy.acknowledge(*frame);
  }
  EXPECT_GT(frames, 3);
  EXPECT_FALSE(silent.await_frame(0.2).has_value());
}

TEST_F(ViewServerTest, AStoppedReaderStallsNobodyEither) {
  WebClient deaf(port()), busy(port());
  for (int k = 0; k < 3000; ++k) deaf.send(std::string_view(R"({"do": "explode"})"));  // and never reads what is said
  busy.send(json{{"do", "play"}});
  for (int k = 0; k < 20; ++k) {
    const auto frame = busy.await_frame();
    ASSERT_TRUE(frame.has_value());
    busy.acknowledge(*frame);
  }
}

TEST_F(ViewServerTest, StreamsPositionsToWhoAsks) {
  const auto model = clamped_view_model();
  WebClient plain(port()), other(port());
  ASSERT_EQ(plain.await_frame()->num_floats(), static_cast<std::uint32_t>(model->dim()));
  other.send(json{{"do", "stream"}, {"what", "positions"}});
  auto frame = other.await_frame();
  while (frame && frame->num_floats() == static_cast<std::uint32_t>(model->dim())) {  // sent before it asked
    other.acknowledge(*frame);
    frame = other.await_frame();
  }
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(frame->num_floats(), static_cast<std::uint32_t>(3 * model->geometry.num_surface_nodes));
  EXPECT_EQ(frame->bytes.size(), 96 + 12 * static_cast<std::size_t>(model->geometry.num_surface_nodes));
}

TEST_F(ViewServerTest, ClosesWithinASecondWhoeverIsThere) {
  WebClient one(port()), other(port());
  one.await("state");
  one.send(json{{"do", "play"}});
  const Stopwatch watch;
  server.close();
  server.wait();
  EXPECT_LT(watch.seconds(), 1);
  while (one.receive(1)) continue;
  EXPECT_TRUE(one.closed());
  EXPECT_EQ(one.close_code(), 1001);  // going away
}

TEST(ViewServerStartTest, SaysWhyItCannotListen) {
  ViewServer first;
  try {
    ViewServer second({.address = "127.0.0.1", .port = first.port(), .page = {}});
    ADD_FAILURE();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), HasSubstr("cannot be listened on"));
  }
  EXPECT_THROW(ViewServer({.address = "localhost", .port = 0, .page = {}}), InputError);
  EXPECT_EQ(get(first.port(), "/").status, 404);  // there is no page
  EXPECT_THAT(get(first.port(), "/").body, HasSubstr("not built"));
  EXPECT_EQ(get(first.port(), "/model.json").status, 503);
}

TEST(PageTest, IsReadWholeAndWithoutLinks) {
  const std::filesystem::path folder = test_folder();
  std::filesystem::remove_all(folder);
  EXPECT_THROW((void)read_page(folder), InputError);
  std::filesystem::create_directories(folder / "assets");
  EXPECT_THROW((void)read_page(folder), InputError);  // no index.html
  std::ofstream(folder / "index.html") << "<html>";
  std::ofstream(folder / "assets" / "a.css") << "a";
  std::filesystem::create_symlink("/etc/passwd", folder / "secrets.txt");
  const Resources page = read_page(folder);
  EXPECT_EQ(page.size(), 3u);  // with "/"
  EXPECT_EQ(page.at("/").bytes, "<html>");
  EXPECT_EQ(page.at("/assets/a.css").type, "text/css; charset=utf-8");
}

// ---------------------------------------------------------------------------------------------------------------------

/// Messages that are nearly good: values replaced, keys taken away; or, broken, bytes changed.
class Mutation {
 public:
  explicit Mutation(std::uint64_t seed) : random_(seed), good_(good_messages()) {
    for (const auto& [text, reason] : bad_messages()) good_.push_back(text);
  }

  std::string operator()() {
    std::string text = pick(good_);
    if (random_.uniform() < 0.2) return text;
    json message = json::parse(text, nullptr, false);
    if (!message.is_object()) return text;
    for (int k = 0; k < 2; ++k) mutate(message);
    return message.dump();
  }
  std::string broken() {
    std::string text = pick(good_);
    for (int k = 0; k < 3; ++k)
      text[static_cast<std::size_t>(random_.below(static_cast<Index>(text.size())))] =
          static_cast<char>(random_.below(256));
    return text;
  }

 private:
  template <typename T>
  const T& pick(const std::vector<T>& items) {
    return items[static_cast<std::size_t>(random_.below(static_cast<Index>(items.size())))];
  }
  void mutate(json& value) {
    static const json values =
        json::parse(R"([0, 1, -1, 2, 20, 50, 0.5, 1e308, -1e308, 5e-324, 1e18, 4294967296, true, null, "", "x", "y",
        "1e5 m", "edit", "newmark:beta=1e9", [], [1], [0, 0, 0], [1, 2, 3], {}, {"axis": "y", "height": 0}])");
    if (value.is_structured() && !value.empty() && random_.uniform() < 0.85) {
      auto at = value.begin();
      std::advance(at, random_.below(static_cast<Index>(value.size())));
      if (random_.uniform() < 0.08) {
        value.erase(at);
        return;
      }
      return mutate(*at);
    }
    value = values[static_cast<std::size_t>(random_.below(static_cast<Index>(values.size())))];
  }

  Random random_;
  std::vector<std::string> good_;
};

/// Which answers come while the session does whatever random messages ask for; a connection that is closed is opened anew.
TEST_F(ViewServerTest, SurvivesRandomMessages) {
  const int batches = repetitions(20, 2000), in_a_batch = 50;
  Mutation mutation(11);
  auto client = std::make_unique<WebClient>(port());
  int answered = 0, closed = 0;
  for (int batch = 0; batch < batches; ++batch) {
    for (int k = 0; k < in_a_batch; ++k) client->send(std::string_view(mutation()));
    if (batch % 5 == 0) client->send(std::string_view(mutation.broken()));
    const std::string marker = "marker" + std::to_string(batch);
    client->send(json{{"do", "pause"}, {marker, 1}});
    while (true) {
      const json refused = client->await("refused", 60);
      if (refused.is_null()) {
        ASSERT_TRUE(client->closed()) << "silent in batch " << batch;
        client = std::make_unique<WebClient>(port());
        ++closed;
        break;
      }
      if (refused.at("reason").get<std::string>().find(marker) != std::string::npos) {
        ++answered;
        break;
      }
    }
  }
  EXPECT_GT(answered, 0);
  EXPECT_GT(closed, 0);
  // it goes on as if nothing had been
  WebClient fresh(port());
  ASSERT_FALSE(fresh.await("state").is_null());
  fresh.send(json{{"do", "mode"}, {"mode", "simulate"}});
  fresh.send(json{{"do", "reset"}});
  fresh.send(json{{"do", "pause"}});
  const auto frame = fresh.await_frame();
  ASSERT_TRUE(frame.has_value());
  EXPECT_EQ(get(port(), "/model.json").status, 200);
}

}  // namespace

}  // namespace supple::test
