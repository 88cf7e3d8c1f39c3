#include <io/builtin/builtin_spec.hpp>

#include <algorithm>
#include <charconv>

namespace supple {
namespace {

/// Positive whole numbers between separators; empty if the text is anything else.
std::vector<Index> positive_numbers(std::string_view text, char separator) {
  std::vector<Index> numbers;
  while (true) {
    const std::size_t end = std::min(text.find(separator), text.size());
    Index number = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + end, number);
    if (error != std::errc() || rest != text.data() + end || number < 1) return {};
    numbers.push_back(number);
    if (end == text.size()) return numbers;
    text.remove_prefix(end + 1);
  }
}

}  // namespace

BuiltinSpec::BuiltinSpec(std::string_view spec) : text(spec), name(spec.substr(0, spec.find(':'))) {
  if (name.size() < spec.size()) parameters = spec.substr(name.size() + 1);
}

std::vector<Index> BuiltinSpec::numbers(std::size_t count, char separator, const std::string& expectation) const {
  std::vector<Index> values = positive_numbers(parameters, separator);
  if (values.size() != count) fail("expected " + expectation);
  return values;
}

void BuiltinSpec::expect_size(double size) const {
  if (!(size <= max_size)) fail("more than 30 million elements or lattice cells; expected smaller numbers");
}

void BuiltinSpec::fail(const std::string& message) const {
  throw InputError(std::string(text) + ": " + message);
}

double product(const std::vector<Index>& numbers) {
  double result = 1;
  for (const Index n : numbers) result *= static_cast<double>(n);
  return result;
}

}  // namespace supple
