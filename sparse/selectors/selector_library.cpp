#include <core/check.hpp>
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

Selection AnySelector::checked(Selection selection, Index cols) const {
  const auto expect = [&](bool holds, const std::string& what) {
    if (!holds) throw SolverError("selector '" + name_ + "' broke its promise: it answered with " + what);
  };
  const std::vector<Index>& indices = selection.indices;
  expect(selection.weights.size() == selection.size(),
         std::to_string(selection.weights.size()) + " weights for " + std::to_string(selection.size()) + " columns");
  expect(selection.weights.allFinite(), "a weight that is not finite");
  for (std::size_t k = 0; k < indices.size(); ++k) {
    expect(0 <= indices[k] && indices[k] < cols,
           "column " + std::to_string(indices[k]) + " of " + std::to_string(cols));
    expect(k == 0 || indices[k - 1] < indices[k], "columns that do not ascend");
  }
  return selection;
}

Selection select_by_name(std::string_view choice, const AnyProblem& problem, const SelectionRequest& request,
                         std::uint64_t seed) {
  return AnySelector(choice, seed)(problem, request);
}

}  // namespace supple
