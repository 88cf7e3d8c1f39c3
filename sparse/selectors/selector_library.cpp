#include <sparse/selectors/selector_library.hpp>
#include <sparse/selectors/selectors.hpp>

namespace supple {

const std::vector<std::string>& known_selectors() {
  static const std::vector<std::string> names(selector_names.begin(), selector_names.end());
  return names;
}

Selection select_by_name(std::string_view name, const AnyProblem& problem, const SelectionRequest& request,
                         std::uint64_t seed) {
  return with_selector(name, seed, [&](const auto& select) -> Selection { return select(problem, request); });
}

}  // namespace supple
