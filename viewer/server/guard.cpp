#include <viewer/server/guard.hpp>

#include <random>

namespace supple {

namespace {

/// "[::1]:80" → "::1", "localhost:80" → "localhost"
std::string_view name_of_host(std::string_view host) {
  if (host.starts_with('[')) return host.substr(1, host.find(']') - 1);
  return host.substr(0, host.find(':'));
}

/// Names of hosts are the same in any case.
std::string lower_case(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if ('A' <= c && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

/// Takes as long for any two texts of one length.
bool same_secret(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t k = 0; k < a.size(); ++k) difference |= static_cast<unsigned>(a[k] ^ b[k]);
  return difference == 0;
}

/// The value of "key=…" among parts that a separator keeps apart.
std::optional<std::string_view> value_of(std::string_view key, std::string_view parts, char separator) {
  while (!parts.empty()) {
    const std::size_t end = std::min(parts.find(separator), parts.size());
    std::string_view part = parts.substr(0, end);
    while (part.starts_with(' ')) part.remove_prefix(1);
    if (part.size() > key.size() && part.starts_with(key) && part[key.size()] == '=')
      return part.substr(key.size() + 1);
    parts.remove_prefix(std::min(end + 1, parts.size()));
  }
  return {};
}

}  // namespace

bool Guard::allows_host(std::string_view host, std::string_view address) const {
  const std::string name = lower_case(name_of_host(host));
  if (name.empty()) return false;
  const bool loops = address.starts_with("127.") || address == "::1";
  return name == address || (!machine.empty() && name == lower_case(machine)) ||
         (loops && (name == "localhost" || name == "127.0.0.1" || name == "::1"));
}

bool Guard::allows_origin(std::optional<std::string_view> origin, std::string_view host) const {
  return !origin || *origin == "http://" + std::string(host);
}

bool Guard::allows_token(std::string_view query, std::string_view cookies) const {
  if (token.empty()) return true;
  const auto in_query = value_of("token", query, '&'), in_cookie = value_of(cookie, cookies, ';');
  return (in_query && same_secret(*in_query, token)) || (in_cookie && same_secret(*in_cookie, token));
}

std::string random_token() {
  std::random_device bits;
  std::string token;
  for (int k = 0; k < 32; ++k) token += "0123456789abcdef"[bits() % 16];
  return token;
}

}  // namespace supple
