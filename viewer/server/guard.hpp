#pragma once
/// \file Guard of a server: which requests are answered.

#include <optional>
#include <string>
#include <string_view>

namespace supple {

/// A path and what follows its '?'.
struct Target {
  std::string_view path, query;

  explicit Target(std::string_view target)
      : path(target.substr(0, target.find('?'))),
        query(path.size() < target.size() ? target.substr(path.size() + 1) : std::string_view()) {}
};

/// Says who may connect. A page of somebody else's in the same browser must not reach a session, by whatever name it
/// calls this machine: a request names an address of the server as its Host, and a page comes from there (its Origin).
struct Guard {
  std::string token;              ///< that requests have to know; empty: none
  std::string machine;            ///< a name that the server may be called by, beside its addresses; may be empty
  std::string cookie = "supple";  ///< that keeps the token in a browser

  /// \param host  of the request, "127.0.0.1:8080"; any port, for tunnels have theirs.
  /// \param address  of the server's end of the connection.
  bool allows_host(std::string_view host, std::string_view address) const;
  /// \param origin  of a page; none: no page.
  bool allows_origin(std::optional<std::string_view> origin, std::string_view host) const;
  /// The token is in the query, or in the cookie that the first answer with it has set.
  bool allows_token(std::string_view query, std::string_view cookies) const;
};

/// 128 random bits, hexadecimal.
std::string random_token();

}  // namespace supple
