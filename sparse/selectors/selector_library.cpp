#include <sparse/selectors/selector_library.hpp>
#include <sparse/selectors/selectors.hpp>

namespace supple {

Registry<NamedSelector>& selectors() {
  static Registry<NamedSelector> all(
      "selector", std::apply(
                      [](const auto&... entries) {
                        return std::vector{named_selector(std::string(entries.name), std::string(entries.description),
                                                          entries.options)...};
                      },
                      selector_table()));
  return all;
}

std::vector<std::string> known_selectors() {
  return selectors().names();
}

AnySelector::AnySelector(std::string_view text, std::uint64_t seed) {
  const Choice choice = Choice::parse(text);
  name_ = choice.name;
  run_ = selectors().at(choice.name).make(choice.options, seed);
}

Selection select_by_name(std::string_view choice, const AnyProblem& problem, const SelectionRequest& request,
                         std::uint64_t seed) {
  return AnySelector(choice, seed)(problem, request);
}

}  // namespace supple
