#include <tests/viewer_session/web_client.hpp>

#include <utility>

#define BOOST_ASIO_NO_DEPRECATED
#define BOOST_BEAST_USE_STD_STRING_VIEW
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/read.hpp>
#include <boost/asio/write.hpp>
#include <boost/beast/core/buffers_to_string.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket.hpp>

#include <chrono>
#include <cstring>
#include <stdexcept>

namespace supple::test {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace websocket = beast::websocket;
using Tcp = asio::ip::tcp;
using Error = boost::system::error_code;

HttpAnswer ask(std::uint16_t port, const std::string& request) {
  asio::io_context io;
  Tcp::socket socket(io);
  socket.connect({asio::ip::address_v4::loopback(), port});
  Error error;
  asio::write(socket, asio::buffer(request), error);
  std::string all;
  asio::read(socket, asio::dynamic_buffer(all), error);  // to the end
  HttpAnswer answer;
  const std::size_t end = all.find("\r\n\r\n");
  answer.head = all.substr(0, end);
  if (end != std::string::npos) answer.body = all.substr(end + 4);
  if (all.size() > 12) answer.status = std::atoi(all.c_str() + 9);
  return answer;
}

HttpAnswer get(std::uint16_t port, const std::string& target, const std::string& more) {
  return ask(port, "GET " + target + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) +
                       "\r\nConnection: close\r\n" + more + "\r\n");
}

struct WebClient::Socket {
  asio::io_context io;
  websocket::stream<beast::tcp_stream, false> stream{io};
  beast::flat_buffer buffer;
  bool closed = false;

  /// Whether an operation that was begun ends in time.
  bool run(const bool& done, double seconds) {
    io.restart();
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!done && std::chrono::steady_clock::now() < end)
      io.run_one_until(std::chrono::time_point_cast<std::chrono::steady_clock::duration>(end));
    return done;
  }
};

WebClient::WebClient(std::uint16_t port, const Options& options) : socket_(std::make_unique<Socket>()) {
  auto& stream = socket_->stream;
  stream.next_layer().socket().connect({asio::ip::address_v4::loopback(), port});
  stream.set_option(websocket::stream_base::decorator([&](websocket::request_type& request) {
    if (!options.origin.empty()) request.set(beast::http::field::origin, options.origin);
  }));
  stream.read_message_max(0);
  Error error;
  const std::string host = options.host.empty() ? "127.0.0.1:" + std::to_string(port) : options.host;
  stream.handshake(host, options.target, error);
  if (error) throw std::runtime_error("the handshake is refused: " + error.message());
}

WebClient::WebClient(WebClient&&) noexcept = default;
WebClient::~WebClient() = default;

void WebClient::send(std::string_view text) {
  Error error;
  socket_->stream.text(true);
  socket_->stream.write(asio::buffer(text.data(), text.size()), error);
}
void WebClient::send_binary(std::string_view bytes) {
  Error error;
  socket_->stream.binary(true);
  socket_->stream.write(asio::buffer(bytes.data(), bytes.size()), error);
}

std::optional<WebClient::Received> WebClient::receive(double seconds) {
  if (socket_->closed) return {};
  bool done = false;
  Error error;
  socket_->stream.async_read(socket_->buffer, [&](Error e, std::size_t) {
    error = e;
    done = true;
  });
  if (!socket_->run(done, seconds)) {
    beast::get_lowest_layer(socket_->stream).cancel();  // no read survives the end of this
    if (!socket_->run(done, 1)) error = asio::error::timed_out;
  }
  if (error) {
    socket_->closed = true;
    return {};
  }
  Received received{socket_->stream.got_binary(), beast::buffers_to_string(socket_->buffer.data())};
  socket_->buffer.consume(socket_->buffer.size());
  return received;
}

nlohmann::json WebClient::await(const std::string& say, double seconds) {
  while (const auto received = receive(seconds)) {
    if (received->is_frame) {
      acknowledge(*received);
      continue;
    }
    const auto json = nlohmann::json::parse(received->bytes);
    if (json.at("say") == say) return json;
  }
  return {};
}

std::optional<WebClient::Received> WebClient::await_frame(double seconds) {
  while (auto received = receive(seconds))
    if (received->is_frame) return received;
  return {};
}

bool WebClient::closed() const {
  return socket_->closed;
}
int WebClient::close_code() const {
  return socket_->stream.reason().code;
}

namespace {
template <typename T>
T read(const std::string& bytes, std::size_t offset) {
  T value{};
  if (bytes.size() >= offset + sizeof value) std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}
}  // namespace

std::uint32_t WebClient::Received::frame_number() const {
  return read<std::uint32_t>(bytes, 4);
}
double WebClient::Received::time() const {
  return read<double>(bytes, 8);
}
std::uint32_t WebClient::Received::num_floats() const {
  return read<std::uint32_t>(bytes, 76);
}

}  // namespace supple::test
