#include <core/check.hpp>
#include <physics/body/force_models.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/model_ladder.hpp>

#include <algorithm>
#include <charconv>

namespace supple {

namespace {

/// What the size of a model follows from.
struct Kind {
  bool thin, free;

  /// `modes` and so many leading components of their derivatives; s = 4/3 d, of shells 8/3 d.
  ModelRung derivatives(Index modes, Index num_derivatives) const {
    const Index d = modes + num_derivatives + (free ? 12 : 0);
    return rung("derivatives:num_derivatives=" + std::to_string(num_derivatives), modes, d, (thin ? 8 * d : 4 * d) / 3);
  }
  /// Rigid modes of free objects span twelve dimensions together.
  ModelRung extended(Index modes, Index points) const {
    return rung("extended", modes, free ? 9 * (modes - 6) + 12 : 9 * modes, points);
  }

 private:
  static ModelRung rung(std::string subspace, Index modes, Index dimension, Index points) {
    ModelRung rung{.options = {}, .dimension = dimension};
    rung.options.subspace = std::move(subspace);
    rung.options.modes = modes;
    rung.options.points = points;
    return rung;
  }
};

}  // namespace

std::vector<ModelRung> model_ladder(const Body& body, const ReduceOptions& options) {
  const Kind kind{.thin = std::holds_alternative<Shell>(body), .free = fixed_nodes(body).empty()};
  std::vector<ModelRung> ladder{kind.derivatives(10, 20), kind.derivatives(15, 45), kind.derivatives(20, 70)};
  if (kind.thin)
    for (const Index points : {150, 250, 400}) ladder.push_back(kind.extended(15, points));
  else
    ladder.insert(ladder.end(), {kind.extended(15, 150), kind.derivatives(30, 105)});
  std::ranges::stable_sort(
      ladder, {}, [](const ModelRung& rung) { return relative_step_time(rung.dimension, rung.options.points); });
  const Index unknowns = 3 * (num_nodes(body) - static_cast<Index>(fixed_nodes(body).size()));
  const Index components = with_force_model(body, [](const auto& model) { return model->num_components(); });
  std::vector<ModelRung> fitting;
  for (const auto& [own, dimension] : ladder) {
    if (!fitting.empty() && (2 * dimension > unknowns || own.points > components)) continue;
    ModelRung& rung = fitting.emplace_back(ModelRung{options, dimension});
    rung.options.subspace = own.subspace;
    rung.options.modes = own.modes;
    rung.options.dimension = 0;
    rung.options.points = own.points;
  }
  return fitting;
}

std::string in_words(const ReduceOptions& options) {
  std::string words = options.subspace + ":modes=" + std::to_string(options.modes);
  if (options.dimension > 0) words += ":dimension=" + std::to_string(options.dimension);
  if (options.points > 0) words += ":points=" + std::to_string(options.points);
  return words;
}

ModelWords ModelWords::parse(std::string_view text) {
  ModelWords words;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(':', begin), text.size());
    const std::string_view part = text.substr(begin, end - begin);
    const std::size_t equals = std::min(part.find('='), part.size());
    const std::string_view name = part.substr(0, equals);
    std::optional<Index>* const number = begin == 0            ? nullptr
                                         : name == "modes"     ? &words.modes
                                         : name == "dimension" ? &words.dimension
                                         : name == "points"    ? &words.points
                                                               : nullptr;
    if (number) {
      require(!number->has_value(), "'" + std::string(text) + "' has the option '" + std::string(name) + "' twice");
      const std::string_view digits = part.substr(std::min(equals + 1, part.size()));
      Index value = 0;
      const auto [rest, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
      require(error == std::errc() && rest == digits.data() + digits.size() && value > 0,
              "'" + std::string(text) + "': " + std::string(name) + " is '" + std::string(digits) +
                  "', expected a whole number from 1 up");
      *number = value;
    } else {
      words.subspace += (begin == 0 ? "" : ":") + std::string(part);
    }
    begin = end + 1;
  }
  check(SubspaceChoice{.name = words.subspace, .modes = 1, .dimension = 0, .snapshots = Matrix::Zero(1, 1)});
  return words;
}

double relative_step_time(Index dimension, Index points) {
  const auto d = static_cast<double>(dimension), s = static_cast<double>(points);
  return 1500 + s * d + d * d;
}

}  // namespace supple
