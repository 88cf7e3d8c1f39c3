#include <sparse/nn_htp.hpp>
#include <sparse/nn_sp.hpp>
#include <sparse/selector_library.hpp>

#include <functional>

namespace supple {

namespace {

struct Entry {
  std::string name;
  std::function<Selection(const AnyProblem&, const SelectionRequest&, std::uint64_t seed)> select;
};

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all{
      {"nn-sp", [](const auto& p, const auto& r, auto seed) { return NnSp{.seed = seed}(p, r); }},
      {"nn-htp", [](const auto& p, const auto& r, auto seed) { return NnHtp{.seed = seed}(p, r); }},
  };
  return all;
}

}  // namespace

const std::vector<std::string>& selector_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> result;
    for (const Entry& entry : entries()) result.push_back(entry.name);
    return result;
  }();
  return names;
}

Selection select_by_name(std::string_view name, const AnyProblem& problem, const SelectionRequest& request,
                         std::uint64_t seed) {
  for (const Entry& entry : entries())
    if (entry.name == name) return entry.select(problem, request, seed);
  std::string known;
  for (const std::string& n : selector_names()) known += (known.empty() ? "" : ", ") + n;
  throw std::invalid_argument("selector '" + std::string(name) + "' is not known, expected one of " + known);
}

}  // namespace supple
