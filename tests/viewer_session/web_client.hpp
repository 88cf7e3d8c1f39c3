#pragma once
/// \file Clients of a server on the loopback interface, for tests.

#include <nlohmann/json.hpp>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace supple::test {

/// What a server answers to a request.
struct HttpAnswer {
  int status = 0;  ///< 0: it closed the connection
  std::string head, body;

  bool has(std::string_view text) const { return head.find(text) != std::string::npos; }
};
/// Sends these bytes as they are, and reads until the server closes.
HttpAnswer ask(std::uint16_t port, const std::string& request);
/// GET with the right Host. \param more  header lines, each with its end.
HttpAnswer get(std::uint16_t port, const std::string& target, const std::string& more = "");

/// A WebSocket to the session.
class WebClient {
 public:
  struct Options {
    std::string target = "/session";
    std::string host;    ///< empty: the right one
    std::string origin;  ///< empty: none
  };
  /// \throws std::runtime_error if the handshake is refused.
  explicit WebClient(std::uint16_t port) : WebClient(port, Options{}) {}
  WebClient(std::uint16_t port, const Options& options);
  WebClient(WebClient&&) noexcept;
  ~WebClient();

  void send(std::string_view text);  ///< what cannot be sent any more is not
  void send(const nlohmann::json& message) { send(std::string_view(message.dump())); }
  void send_binary(std::string_view bytes);

  struct Received {
    bool is_frame = false;
    std::string bytes;

    std::uint32_t frame_number() const;
    double time() const;               ///< of a frame [s]
    std::uint32_t num_floats() const;  ///< of a frame
  };
  /// Nothing if the connection is closed, or silent for so long.
  std::optional<Received> receive(double seconds = 10);
  /// The next text of a kind; frames on the way are acknowledged. A null if it does not come.
  nlohmann::json await(const std::string& say, double seconds = 10);
  /// The next frame, not acknowledged.
  std::optional<Received> await_frame(double seconds = 10);
  void acknowledge(const Received& frame) { send(nlohmann::json{{"do", "ack"}, {"frame", frame.frame_number()}}); }

  bool closed() const;
  int close_code() const;  ///< that the server gave; 0: none

 private:
  struct Socket;
  std::unique_ptr<Socket> socket_;
};

}  // namespace supple::test
