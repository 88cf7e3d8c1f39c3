#include <core/check.hpp>
#include <viewer/server/guard.hpp>
#include <viewer/server/hub.hpp>
#include <viewer/server/view_server.hpp>

#include <utility>  // which Asio of Boost 1.74 uses and does not include

#define BOOST_ASIO_NO_DEPRECATED
#define BOOST_BEAST_USE_STD_STRING_VIEW
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include <atomic>
#include <condition_variable>
#include <mutex>
#include <netinet/tcp.h>
#include <set>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace supple {

namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Error = boost::system::error_code;
using namespace std::chrono_literals;

constexpr std::size_t most_connections = 128;
constexpr std::uint32_t largest_header = 16 << 10;  // [bytes]
constexpr auto request_time = 10s;   // to send a request: who has shown no token yet holds no place longer
constexpr auto answer_time = 10min;  // to take an answer: megabytes, through whatever tunnel
constexpr int silence = 60;          // of a client's machine, until it counts as gone [s]
constexpr auto farewell = 300ms;     // for clients to take leave

constexpr std::string_view busy =
    "HTTP/1.1 503 Service Unavailable\r\nContent-Type: text/plain; charset=utf-8\r\nContent-Length: 35\r\n"
    "Retry-After: 5\r\nConnection: close\r\n\r\nthere are too many connections now\n";

constexpr std::string_view no_page =
    "The page of `supple view` was not built. Build the target viewer_page, which says what is missing (npm, or the\n"
    "packages that it fetches), or name a built page by --page. The session at /session runs, and speaks\n"
    "docs/viewer-protocol.md.\n";

std::string machine_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "";
}

/// Lets the system find out whether the other machine still lives: no timer of ours is touched by a frame.
void watch(Tcp::socket& socket) {
  const auto set = [&](int option, int value) {
    ::setsockopt(socket.native_handle(), IPPROTO_TCP, option, &value, sizeof value);
  };
  socket.set_option(asio::socket_base::keep_alive(true));
  set(TCP_KEEPIDLE, silence / 2);
  set(TCP_KEEPINTVL, silence / 6);
  set(TCP_KEEPCNT, 3);
  set(TCP_USER_TIMEOUT, 1000 * silence);
}

/// "::1" → "[::1]"
std::string in_url(const asio::ip::address& address) {
  return address.is_v6() ? "[" + address.to_string() + "]" : address.to_string();
}

/// Connections that live, to be counted and told of news.
class Client {
 public:
  virtual ~Client() = default;
  virtual void pump() = 0;   ///< sends and reads what there is
  virtual void leave() = 0;  ///< says farewell, then ends
  virtual void end() = 0;    ///< closes the connection
};

/// What connections share. All of it belongs to the thread of the network, but the hub.
struct Server {
  Hub& hub;
  asio::io_context& io;
  Guard guard;
  Resources page;
  std::size_t connections = 0;
  std::set<std::shared_ptr<Client>> clients = {};
  bool closing = false;
};

/// Counts a connection for as long as it lives.
class Counted {
 public:
  explicit Counted(Server& server) : server_(&server) { ++server.connections; }
  Counted(Counted&& other) noexcept : server_(std::exchange(other.server_, nullptr)) {}
  Counted& operator=(Counted&&) = delete;
  ~Counted() {
    if (server_) --server_->connections;
  }

 private:
  Server* server_;
};

// ---------------------------------------------------------------------------------------------------------------------

/// A client of the session, on a WebSocket.
class Session final : public Client, public std::enable_shared_from_this<Session> {
 public:
  Session(Server& server, Counted counted, beast::tcp_stream stream)
      : server_(server), counted_(std::move(counted)), socket_(std::move(stream)) {}
  void start(const http::request<http::empty_body>& request) {
    beast::get_lowest_layer(socket_).expires_never();
    beast::get_lowest_layer(socket_).socket().set_option(Tcp::no_delay(true));
    socket_.set_option(websocket::stream_base::timeout{request_time, websocket::stream_base::none(), false});
    socket_.read_message_max(largest_message);
    socket_.async_accept(request, [self = shared_from_this()](Error error) {
      if (error || self->server_.closing) return;
      self->id_ = self->server_.hub.connect();
      self->server_.clients.insert(self);
      self->pump();
    });
  }

  void pump() override {
    if (leaving_) return;
    if (!writing_) write();
    if (!reading_ && server_.hub.wants_more(id_)) read();
  }

  void leave() override { close({websocket::close_code::going_away, "the server ends"}); }

  /// Nothing more is read or written, and the last handler takes this away.
  void end() override {
    leaving_ = true;
    Error ignored;
    beast::get_lowest_layer(socket_).socket().close(ignored);
    if (server_.clients.erase(shared_from_this()) > 0) server_.hub.disconnect(id_);
    if (server_.closing && server_.clients.empty()) server_.io.stop();
  }

 private:
  void read() {
    reading_ = true;
    socket_.async_read(buffer_, [self = shared_from_this()](Error error, std::size_t) { self->on_read(error); });
  }
  void on_read(Error error) {
    reading_ = false;
    if (error) return end();
    if (!socket_.got_text()) {
      server_.hub.refuse(id_, "", "a binary message, expected text");
    } else {
      const auto bytes = buffer_.cdata();
      if (!server_.hub.receive(id_, {static_cast<const char*>(bytes.data()), bytes.size()}))
        return close({websocket::close_code::bad_payload, "this is no JSON"});
    }
    buffer_.consume(buffer_.size());
    pump();
  }

  void write() {
    std::optional<Outgoing> next = server_.hub.next(id_);
    if (!next) return;
    writing_ = true;
    outgoing_ = std::move(next->bytes);
    socket_.binary(next->is_frame);
    socket_.async_write(asio::buffer(*outgoing_), [self = shared_from_this()](Error error, std::size_t) {
      self->writing_ = false;
      if (error) return self->end();
      if (self->close_with_) return self->close(*self->close_with_);
      self->pump();
    });
  }

  void close(const websocket::close_reason& reason) {
    if (id_ == 0 || closed_) return;
    leaving_ = true;
    close_with_ = reason;
    if (writing_) return;  // one thing at a time
    closed_ = true;
    socket_.async_close(reason, [self = shared_from_this()](Error) { self->end(); });
  }
  Server& server_;
  Counted counted_;
  websocket::stream<beast::tcp_stream, /*deflate=*/false> socket_;
  beast::flat_buffer buffer_;
  std::shared_ptr<const std::string> outgoing_;
  std::optional<websocket::close_reason> close_with_;
  int id_ = 0;
  bool reading_ = false, writing_ = false, leaving_ = false, closed_ = false;
};

// ---------------------------------------------------------------------------------------------------------------------

/// A connection that asks for resources, until it asks for a WebSocket.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(Server& server, Tcp::socket socket) : server_(server), counted_(server), stream_(std::move(socket)) {
    Error error;
    address_ = stream_.socket().local_endpoint(error).address();
    watch(stream_.socket());
  }

  void read() {
    parser_.emplace();
    parser_->header_limit(largest_header);
    parser_->body_limit(0);
    stream_.expires_after(request_time);
    http::async_read(stream_, buffer_, *parser_,
                     [self = shared_from_this()](Error error, std::size_t) { self->on_read(error); });
  }

 private:
  using Body = http::span_body<const char>;

  void on_read(Error error) {
    if (error == http::error::header_limit)
      return refuse(http::status::request_header_fields_too_large, "the request's header is too large");
    if (error == http::error::body_limit) return refuse(http::status::payload_too_large, "a request has no body here");
    if (error == http::error::end_of_stream || error == asio::error::eof) return end();
    if (error.category() == http::make_error_code(http::error::bad_version).category())
      return refuse(http::status::bad_request, "this is no request");
    if (error || server_.closing) return;
    answer();
  }

  std::string_view field(http::field name) const {
    const auto value = parser_->get()[name];
    return {value.data(), value.size()};
  }

  void answer() {
    const auto& request = parser_->get();
    const std::string_view host = field(http::field::host);
    const Target target({request.target().data(), request.target().size()});
    if (!server_.guard.allows_host(host, address_.to_string()))
      return refuse(http::status::forbidden, "this server does not answer by that name; use its address");
    const bool has_origin = request.find(http::field::origin) != request.end();
    if (!server_.guard.allows_origin(has_origin ? std::optional(field(http::field::origin)) : std::nullopt, host))
      return refuse(http::status::forbidden, "a page of another origin may not come here");
    if (!server_.guard.allows_token(target.query, field(http::field::cookie)))
      return refuse(http::status::unauthorized, "the token is missing: open the address that supple view has printed");
    if (target.path == "/session") {
      if (!websocket::is_upgrade(request))
        return refuse(http::status::upgrade_required, "the session speaks WebSocket");
      std::make_shared<Session>(server_, std::move(counted_), std::move(stream_))->start(request);
      return;
    }
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return refuse(http::status::method_not_allowed, "only GET and HEAD are answered");
    if (target.path == "/model.json" ||
        target.path.starts_with("/model/")) {  // of no page, whatever its files are called
      const auto model = server_.hub.resources();
      if (!model) return refuse(http::status::service_unavailable, "the model is not ready yet");
      if (const auto array = model->find(target.path); array != model->end()) {
        model_ = model;
        return send(array->second);
      }
    } else if (const auto file = server_.page.find(target.path); file != server_.page.end()) {
      return send(file->second);
    }
    refuse(http::status::not_found, server_.page.empty() && target.path == "/" ? no_page : "there is nothing here");
  }

  void refuse(http::status status, std::string_view reason) {
    text_ = {"text/plain; charset=utf-8", std::string(reason) + (reason.ends_with('\n') ? "" : "\n")};
    send(text_, status);
  }

  void send(const Resource& resource, http::status status = http::status::ok) {
    const auto& request = parser_->get();
    const bool known = parser_->is_done();
    response_ = {status, known ? request.version() : 11u};
    response_.set(http::field::content_type, resource.type);
    response_.set(http::field::cache_control, "no-store");
    response_.set("X-Content-Type-Options", "nosniff");
    response_.set("Cross-Origin-Resource-Policy", "same-origin");
    response_.set("Content-Security-Policy", "frame-ancestors 'none'");
    response_.set("Referrer-Policy", "no-referrer");
    if (status == http::status::ok && !server_.guard.token.empty())
      response_.set(http::field::set_cookie,
                    server_.guard.cookie + "=" + server_.guard.token + "; HttpOnly; SameSite=Strict; Path=/");
    response_.keep_alive(known && request.keep_alive());
    response_.content_length(resource.bytes.size());
    if (!known || request.method() != http::verb::head)
      response_.body() = {resource.bytes.data(), resource.bytes.size()};
    stream_.expires_after(answer_time);
    http::async_write(stream_, response_, [self = shared_from_this()](Error error, std::size_t) {
      if (error) return;
      self->model_.reset();
      if (!self->response_.keep_alive()) return self->end();
      self->read();
    });
  }

  void end() {
    Error ignored;
    stream_.socket().shutdown(Tcp::socket::shutdown_send, ignored);
  }

  Server& server_;
  Counted counted_;
  beast::tcp_stream stream_;
  asio::ip::address address_;
  beast::flat_buffer buffer_;
  std::optional<http::request_parser<http::empty_body>> parser_;
  http::response<Body> response_;
  Resource text_;
  std::shared_ptr<const Resources> model_;  // while it is being sent
};

}  // namespace

// ---------------------------------------------------------------------------------------------------------------------

class ViewServer::Network {
 public:
  explicit Network(ServerOptions options)
      : hub_([this] { wake(); }), server_{.hub = hub_, .io = io_, .guard = {}, .page = std::move(options.page)} {
    Error error;
    const auto address = asio::ip::make_address(options.address, error);
    if (error)
      throw InputError("'" + options.address + "' is no IP address to listen on, expected one such as 127.0.0.1");
    const auto check = [&] {
      if (error)
        throw InputError("port " + std::to_string(options.port) + " of " + options.address +
                         " cannot be listened on: " + error.message());
    };
    acceptor_.open(address.is_v6() ? Tcp::v6() : Tcp::v4(), error);
    check();
    acceptor_.set_option(asio::socket_base::reuse_address(true), error);
    acceptor_.bind({address, options.port}, error);
    check();
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
    check();
    port_ = acceptor_.local_endpoint().port();
    Guard& guard = server_.guard;
    guard.cookie += "-" + std::to_string(port_);
    if (!address.is_loopback()) guard.token = random_token();
    if (address.is_unspecified()) guard.machine = machine_name();
    url_ = "http://" + (guard.machine.empty() ? in_url(address) : guard.machine) + ":" + std::to_string(port_) + "/" +
           (guard.token.empty() ? "" : "?token=" + guard.token);
    accept();
    thread_ = std::thread([this] { run(); });
  }

  ~Network() {
    close();
    thread_.join();
    hub_.end();  // while there is something to wake
    server_.clients.clear();
  }

  void wait() {
    std::unique_lock lock(mutex_);
    ended_changed_.wait(lock, [&] { return ended_; });
  }

  void close() {
    asio::post(io_, [this] {
      if (std::exchange(server_.closing, true)) return;
      Error ignored;
      acceptor_.close(ignored);
      for (const auto& client : std::set(server_.clients)) client->leave();
      timer_.expires_after(server_.clients.empty() ? 0ms : farewell);
      timer_.async_wait([this](Error) {
        for (const auto& client : std::set(server_.clients)) client->end();
        io_.stop();
      });
    });
  }

  Hub& hub() { return hub_; }
  std::uint16_t port() const { return port_; }
  const std::string& token() const { return server_.guard.token; }
  const std::string& url() const { return url_; }

 private:
  void run() {
    while (true) {
      try {
        io_.run();
        break;
      } catch (const std::exception&) {  // of one connection, which is gone with its handler
      }
    }
    {
      const std::lock_guard lock(mutex_);
      ended_ = true;
    }
    ended_changed_.notify_all();
  }

  void accept() {
    acceptor_.async_accept([this](Error error, Tcp::socket socket) {
      if (server_.closing) return;
      if (!error && server_.connections < most_connections) {
        std::make_shared<Connection>(server_, std::move(socket))->read();
      } else if (!error) {
        Error ignored;
        socket.non_blocking(true, ignored);
        socket.send(asio::buffer(busy), 0, ignored);
      }
      if (!error) return accept();
      pause_.expires_after(100ms);  // such as too many open files
      pause_.async_wait([this](Error) { accept(); });
    });
  }

  /// News for clients, from any thread; no more than one call of theirs waits.
  void wake() {
    if (woken_.exchange(true)) return;
    asio::post(io_, [this] {
      woken_ = false;
      for (const auto& client : std::set(server_.clients)) client->pump();
    });
  }

  std::atomic<bool> woken_ = false;
  std::mutex mutex_;
  std::condition_variable ended_changed_;
  bool ended_ = false;
  std::uint16_t port_ = 0;
  std::string url_;
  Hub hub_;
  Server server_;
  asio::io_context io_{1};
  Tcp::acceptor acceptor_{io_};
  asio::steady_timer timer_{io_}, pause_{io_};
  std::thread thread_;
};

ViewServer::ViewServer(ServerOptions options) : network_(std::make_unique<Network>(std::move(options))) {}
ViewServer::~ViewServer() = default;

std::uint16_t ViewServer::port() const {
  return network_->port();
}
const std::string& ViewServer::token() const {
  return network_->token();
}
std::string ViewServer::url() const {
  return network_->url();
}
void ViewServer::progress(std::string_view stage, double share) {
  network_->hub().progress(stage, share);
}
void ViewServer::serve(std::shared_ptr<const ViewModel> model) {
  network_->hub().serve(std::move(model));
}
void ViewServer::wait() {
  network_->wait();
}
void ViewServer::close() {
  network_->close();
}

}  // namespace supple
