#include <core/check.hpp>
#include <io/text/unit.hpp>

#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

namespace supple {

namespace {

/// factor · m^a kg^b s^c
struct Unit {
  double factor = 1;
  std::array<int, 3> powers{};
};

struct Symbol {
  std::string_view name;
  Unit unit;
  bool takes_prefix;
};
constexpr Symbol symbols[] = {
    {"m", {1, {1, 0, 0}}, true},
    {"g", {1e-3, {0, 1, 0}}, true},
    {"s", {1, {0, 0, 1}}, true},
    {"N", {1, {1, 1, -2}}, true},
    {"Pa", {1, {-1, 1, -2}}, true},
    {"J", {1, {2, 1, -2}}, true},
    {"W", {1, {2, 1, -3}}, true},
    {"Hz", {1, {0, 0, -1}}, true},
    {"rad", {1, {}}, false},
    {"deg", {std::numbers::pi / 180, {}}, false},
    {"°", {std::numbers::pi / 180, {}}, false},
    {"min", {60, {0, 0, 1}}, false},
    {"h", {3600, {0, 0, 1}}, false},
    {"1", {1, {}}, false},
    {"%", {0.01, {}}, false},
};
constexpr std::pair<std::string_view, double> prefixes[] = {
    {"G", 1e9},  {"M", 1e6},  {"k", 1e3},  {"d", 1e-1}, {"c", 1e-2},
    {"m", 1e-3}, {"µ", 1e-6}, {"μ", 1e-6}, {"u", 1e-6}, {"n", 1e-9},
};
constexpr std::pair<std::string_view, int> superscripts[] = {{"⁻¹", -1}, {"⁻²", -2}, {"⁻³", -3},
                                                             {"²", 2},   {"³", 3},   {"⁴", 4}};

std::optional<Unit> find_symbol(std::string_view name) {
  for (const Symbol& symbol : symbols)
    if (name == symbol.name) return symbol.unit;
  for (const auto& [prefix, factor] : prefixes)
    for (const Symbol& symbol : symbols)
      if (symbol.takes_prefix && name.starts_with(prefix) && name.substr(prefix.size()) == symbol.name)
        return Unit{factor * symbol.unit.factor, symbol.unit.powers};
  return {};
}

/// A symbol with its power: "m", "s^2", "s^-2", "m³".
std::optional<Unit> parse_power(std::string_view text) {
  int exponent = 1;
  if (const std::size_t hat = text.find('^'); hat != text.npos) {
    const auto [end, error] = std::from_chars(text.data() + hat + 1, text.data() + text.size(), exponent);
    if (error != std::errc{} || end != text.data() + text.size() || std::abs(exponent) > 9) return {};
    text = text.substr(0, hat);
  } else {
    for (const auto& [mark, value] : superscripts)
      if (text.ends_with(mark)) {
        exponent = value;
        text.remove_suffix(mark.size());
        break;
      }
  }
  std::optional<Unit> unit = find_symbol(text);
  if (!unit) return {};
  unit->factor = std::pow(unit->factor, exponent);
  for (int& power : unit->powers) power *= exponent;
  return unit;
}

std::optional<Unit> parse_unit(std::string_view text) {
  Unit product;
  int sign = 1;
  bool wants_factor = false;
  while (true) {
    while (text.starts_with(' ')) text.remove_prefix(1);
    if (text.empty()) break;
    if (text.front() == '/' || text.front() == '*' || text.starts_with("·")) {
      if (wants_factor || (text.front() == '/' && sign < 0)) return {};  // "a / b / c" has two meanings
      if (text.front() == '/') sign = -1;
      text.remove_prefix(text.starts_with("·") ? 2 : 1);
      wants_factor = true;
      continue;
    }
    std::size_t end = text.find_first_of(" /*");
    end = std::min({end, text.find("·"), text.size()});
    const std::optional<Unit> factor = parse_power(text.substr(0, end));
    if (!factor) return {};
    product.factor *= std::pow(factor->factor, sign);
    for (std::size_t k = 0; k < 3; ++k) product.powers[k] += sign * factor->powers[k];
    text.remove_prefix(end);
    wants_factor = false;
  }
  if (wants_factor) return {};
  return product;
}

}  // namespace

double conversion_factor(std::string_view given, std::string_view unit) {
  const std::optional<Unit> from = parse_unit(given), to = parse_unit(unit);
  require(to.has_value(), "'" + std::string(unit) + "' is not a unit");
  if (!from) throw InputError("'" + std::string(given) + "' is not a unit");
  if (from->powers != to->powers)
    throw InputError("'" + std::string(given) + "' is not a unit of " +
                     (unit.empty() ? "a plain number" : std::string(unit)));
  return from->factor / to->factor;
}

double parse_quantity(std::string_view text, std::string_view unit) {
  double value;
  const std::string_view number = text.starts_with('+') && !text.starts_with("+-") ? text.substr(1) : text;
  const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), value);
  if (error != std::errc{} || !std::isfinite(value)) throw InputError("'" + std::string(text) + "' is not a quantity");
  std::string_view rest = number.substr(static_cast<std::size_t>(end - number.data()));
  while (rest.starts_with(' ')) rest.remove_prefix(1);
  if (rest.empty()) return value;
  value *= conversion_factor(rest, unit);
  if (!std::isfinite(value)) throw InputError("'" + std::string(text) + "' is too large");
  return value;
}

}  // namespace supple
