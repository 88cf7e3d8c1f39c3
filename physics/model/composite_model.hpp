#pragma once
/// \file Sum of several force models on one object: a shell with springs, tets with a skin, two laws.

#include <core/check.hpp>
#include <physics/model/term_pack.hpp>

#include <algorithm>
#include <array>
#include <concepts>
#include <optional>
#include <tuple>
#include <variant>
#include <vector>

namespace supple {

/// The sum of some models over the same nodes, with an energy if each has one. Its components are those of the first
/// model, then those of the second, and so on; selectors see one list. Terms of smaller stencils are filled up with
/// neighbouring nodes on which they do not act. Packs of components of one part run as fast as that part alone.
template <ForceModel First, ForceModel... Others>
class CompositeModel {
 public:
  static constexpr int stencil_size = std::max({First::stencil_size, Others::stencil_size...});
  static constexpr int node_dim = First::node_dim;
  static constexpr int local_dofs = stencil_size * node_dim;
  static constexpr bool translation_invariant =
      is_translation_invariant<First>() && (is_translation_invariant<Others>() && ...);
  static constexpr bool symmetric_tangent = has_symmetric_tangent<First>() && (has_symmetric_tangent<Others>() && ...);
  static_assert(((Others::node_dim == node_dim) && ...), "parts need as many unknowns a node as one another");
  static constexpr std::size_t num_parts = 1 + sizeof...(Others);
  template <std::size_t part>
  using Part = std::tuple_element_t<part, std::tuple<First, Others...>>;

  /// \throws std::invalid_argument if the parts have different numbers of nodes, or fewer than a stencil needs.
  explicit CompositeModel(First first, Others... others)
      : CompositeModel(std::make_shared<const First>(std::move(first)),
                       std::make_shared<const Others>(std::move(others))...) {}
  explicit CompositeModel(std::shared_ptr<const First> first, std::shared_ptr<const Others>... others)
      : parts_(std::move(first), std::move(others)...) {
    Index count = 0;
    for_parts([&](auto part, const auto& model) {
      require_size("nodes of part " + std::to_string(part), model.num_nodes(), num_nodes());
      begin_[part] = count;
      count += model.num_components();
    });
    begin_[num_parts] = count;
    require(num_nodes() >= stencil_size, "there are fewer nodes than a stencil has");
    fill_stencils();
  }

  Index num_nodes() const { return std::get<0>(parts_)->num_nodes(); }
  Index num_components() const { return begin_[num_parts]; }
  std::span<const Index, stencil_size> stencil(Index i) const { return stencils_[i]; }
  const Points& rest_positions() const requires requires(const First& model) { model.rest_positions(); }
  { return std::get<0>(parts_)->rest_positions(); }

  /// The first component of a part; begin(num_parts) is past the end.
  Index begin(std::size_t part) const { return begin_[part]; }
  /// The part that component i belongs to.
  std::size_t part_of(Index i) const {
    std::size_t part = 0;
    while (i >= begin_[part + 1]) ++part;
    return part;
  }
  template <std::size_t which>
  const std::shared_ptr<const Part<which>>& part() const {
    return std::get<which>(parts_);
  }

  double energy(Index i, const Local<local_dofs>& u_i) const
      requires(PotentialModel<First> && (PotentialModel<Others> && ...)) {
    double energy = 0;
    for_part_of(i, [&](const auto& model, Index own) { energy = model.energy(own, own_dofs(model, u_i)); });
    return energy;
  }
  Local<local_dofs> force(Index i, const Local<local_dofs>& u_i) const {
    Local<local_dofs> f = Local<local_dofs>::Zero();
    for_part_of(i, [&]<typename Model>(const Model& model, Index own) {
      f.template head<Model::local_dofs>() = model.force(own, own_dofs(model, u_i));
    });
    return f;
  }
  LocalMatrix<local_dofs> stiffness(Index i, const Local<local_dofs>& u_i) const {
    LocalMatrix<local_dofs> K = LocalMatrix<local_dofs>::Zero();
    for_part_of(i, [&]<typename Model>(const Model& model, Index own) {
      K.template topLeftCorner<Model::local_dofs, Model::local_dofs>() = model.stiffness(own, own_dofs(model, u_i));
    });
    return K;
  }

 private:
  template <typename Body>
  void for_parts(const Body& body) const {
    [&]<std::size_t... part>(std::index_sequence<part...>) {
      (body(std::integral_constant<std::size_t, part>(), *std::get<part>(parts_)), ...);
    }
    (std::make_index_sequence<num_parts>());
  }
  template <typename Body>
  void for_part_of(Index i, const Body& body) const {
    const std::size_t of = part_of(i);
    for_parts([&](std::size_t part, const auto& model) {
      if (part == of) body(model, i - begin_[part]);
    });
  }
  template <typename Model>
  static Local<Model::local_dofs> own_dofs(const Model&, const Local<local_dofs>& u_i) {
    return u_i.template head<Model::local_dofs>();
  }

  void fill_stencils() {
    stencils_.resize(num_components());
    std::vector<std::vector<Index>> around(
        num_nodes());  // full stencils at each node: filling from them couples nothing new
    for_parts([&]<typename Model>(std::size_t part, const Model& model) {
      if constexpr (Model::stencil_size == stencil_size)
        for (Index i = 0; i < model.num_components(); ++i) {
          std::ranges::copy(model.stencil(i), stencils_[begin_[part] + i].begin());
          for (const Index v : model.stencil(i)) around[v].push_back(begin_[part] + i);
        }
    });
    for_parts([&]<typename Model>(std::size_t part, const Model& model) {
      if constexpr (Model::stencil_size < stencil_size)
        for (Index i = 0; i < model.num_components(); ++i) {
          auto& stencil = stencils_[begin_[part] + i];
          auto end = std::ranges::copy(model.stencil(i), stencil.begin()).out;
          const auto add = [&](Index v) {
            if (end != stencil.end() && std::find(stencil.begin(), end, v) == end) *end++ = v;
          };
          const auto holds_all = [&](Index full) {
            return std::all_of(stencil.begin(), end,
                               [&](Index v) { return std::ranges::count(stencils_[full], v) > 0; });
          };
          const std::vector<Index>& near = around[stencil[0]];
          const auto best = std::ranges::find_if(near, holds_all);
          if (!near.empty())
            for (const Index v : stencils_[best == near.end() ? near.front() : *best]) add(v);
          for (Index v = 0; end != stencil.end(); ++v) add(v);
        }
    });
  }

  std::tuple<std::shared_ptr<const First>, std::shared_ptr<const Others>...> parts_;
  std::array<Index, num_parts + 1> begin_;
  std::vector<std::array<Index, stencil_size>> stencils_;
};

/// Eight components of a composite: those of one part as its own pack, mixed ones lane by lane.
template <typename... Models>
class TermPack<CompositeModel<Models...>> {
  using Composite = CompositeModel<Models...>;

 public:
  using Displacements = Local<Composite::local_dofs, Pack>;

  TermPack(const std::shared_ptr<const Composite>& model, const PackIndices& components)
      : model_(model), lanes_(components) {
    const std::size_t part = model->part_of(components[0]);
    if (std::ranges::all_of(components, [&](Index i) { return model->part_of(i) == part; })) {
      PackIndices own = components;
      for (Index& i : own) i -= model->begin(part);
      choose(part, own);
    }
  }
  TermPack(const std::shared_ptr<const Composite>& model, Index component)
      : TermPack(model, one_component(component)) {}

  Pack energy(const Displacements& u) const requires PotentialModel<Composite> {
    return evaluate(
        Pack(0.0), u, [](const auto& terms, const auto& own, Pack& e) { e = terms.energy(own); },
        [&](int k, const auto& own, Pack& e) { e.set(k, model_->energy(lanes_[k], own)); });
  }
  Displacements force(const Displacements& u) const {
    return evaluate(
        Displacements(Displacements::Constant(Pack(0.0))), u,
        [](const auto& terms, const auto& own, Displacements& f) {
          f.template head<std::remove_cvref_t<decltype(own)>::RowsAtCompileTime>() = terms.force(own);
        },
        [&](int k, const auto& own, Displacements& f) {
          const Local<Composite::local_dofs> f_k = model_->force(lanes_[k], own);
          for (int i = 0; i < Composite::local_dofs; ++i) f[i].set(k, f_k[i]);
        });
  }
  LocalMatrix<Composite::local_dofs, Pack> stiffness(const Displacements& u) const {
    using Tangent = LocalMatrix<Composite::local_dofs, Pack>;
    return evaluate(
        Tangent(Tangent::Constant(Pack(0.0))), u,
        [](const auto& terms, const auto& own, Tangent& K) {
          constexpr int size = std::remove_cvref_t<decltype(own)>::RowsAtCompileTime;
          K.template topLeftCorner<size, size>() = terms.stiffness(own);
        },
        [&](int k, const auto& own, Tangent& K) {
          const LocalMatrix<Composite::local_dofs> K_k = model_->stiffness(lanes_[k], own);
          for (Index e = 0; e < K_k.size(); ++e) K.data()[e].set(k, K_k.data()[e]);
        });
  }

 private:
  void choose(std::size_t part, const PackIndices& own) {
    [&]<std::size_t... p>(std::index_sequence<p...>) {
      ((p == part ? (void)terms_.template emplace<p + 1>(model_->template part<p>(), own) : void()), ...);
    }
    (std::make_index_sequence<Composite::num_parts>());
  }

  /// by_part(terms, its displacements, result), or for mixed lanes by_lane(k, displacements, result) for each.
  template <typename Result, typename ByPart, typename ByLane>
  Result evaluate(Result result, const Displacements& u, const ByPart& by_part, const ByLane& by_lane) const {
    std::visit(
        [&]<typename Terms>(const Terms& terms) {
          if constexpr (std::same_as<Terms, std::monostate>) {
            for (int k = 0; k < Pack::size; ++k) {
              Local<Composite::local_dofs> own;
              for (int i = 0; i < Composite::local_dofs; ++i) own[i] = u[i][k];
              by_lane(k, own, result);
            }
          } else {
            using Own = typename Terms::Displacements;
            const Own own = u.template head<Own::RowsAtCompileTime>();
            by_part(terms, own, result);
          }
        },
        terms_);
    return result;
  }

  std::shared_ptr<const Composite> model_;
  PackIndices lanes_;
  std::variant<std::monostate, TermPack<Models>...> terms_;  // monostate: lanes of several parts
};

}  // namespace supple
