#pragma once
/// \file Server of a viewer: page, model and session over HTTP and WebSockets.

#include <viewer/server/resource.hpp>

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

namespace supple {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< to listen on: an IP address
  std::uint16_t port = 0;             ///< 0: a free one
  Resources page = {};                ///< see read_page(); empty: a line that says that there is none
};

/// Serves one model to any number of clients, by docs/viewer-protocol.md, from its construction to close(). The network has a
/// thread, the session another. On any address but the loopback interface's it asks for a token.
///
///     ViewServer server({.page = read_page(folder)});
///     std::puts(server.url().c_str());
///     server.serve(std::make_shared<const ViewModel>(load_model("bar.supple"), "bar"));
///     server.wait();
class ViewServer {
 public:
  /// \throws InputError for an address that cannot be listened on, with the reason.
  explicit ViewServer(ServerOptions options = {});
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  std::uint16_t port() const;
  const std::string& token() const;  ///< empty: none is asked for
  std::string url() const;           ///< where the page is, with the token if there is one

  /// Until there is a model: how far it is, for clients to show.
  void progress(std::string_view stage, double share);
  /// The model is there. \pre called once.
  void serve(std::shared_ptr<const ViewModel> model);

  /// Until close() is called, from another thread.
  void wait();
  /// Takes leave of all clients and ends, within half a second. Safe from any thread, and more than once.
  void close();

 private:
  class Network;
  std::unique_ptr<Network> network_;
};

}  // namespace supple
