#pragma once
/// \file Full system: every node, sparse matrices.

#include <core/check.hpp>
#include <core/pack.hpp>
#include <core/parallel.hpp>
#include <core/text.hpp>
#include <physics/model/explain_force_model.hpp>
#include <physics/model/term_pack.hpp>
#include <physics/system/dynamical_system.hpp>
#include <physics/system/mean_force.hpp>
#include <physics/system/nodal_frames.hpp>
#include <physics/system/node_numbering.hpp>
#include <physics/system/outside_terms.hpp>
#include <physics/system/rest_state.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace supple {

/// Any ForceModel with lumped masses (for heat: capacities [J/K]) and fixed nodes, whose unknowns are zero. Unknowns
/// are the displacements (temperatures) of the free nodes, interleaved (x₀ y₀ z₀ x₁ …); expand() and restrict() go to
/// and from vectors over all nodes. A node that slides, held along some of its axes, keeps three unknowns: where it is held,
/// the model sees no displacement and the unknown is alone on a spring, so fast that its frequency is above all of the
/// object's: it stays zero, and every method that knows nodes of three unknowns works. Forces and tangents are evaluated in packs of eight components; sums have a fixed
/// order, so results do not depend on the number of threads.
template <typename Model>
class FullSystem {
  static_assert(explain_force_model<Model>());

 public:
  using MatrixType = SparseMatrix;
  static constexpr int node_dim = Model::node_dim;
  static constexpr bool symmetric_tangent = has_symmetric_tangent<Model>();

  /// \param nodal_mass  n, > 0 [kg].  \param fixed_nodes  nodes that never move, in any order.
  /// \param held_axes  of others that slide, for unknowns in ℝ³.
  FullSystem(Model model, Vector nodal_mass, const std::vector<Index>& fixed_nodes = {},
             const std::vector<HeldAxes>& held_axes = {})
      : FullSystem(std::make_shared<const Model>(std::move(model)), std::move(nodal_mass), fixed_nodes, held_axes) {}

  FullSystem(std::shared_ptr<const Model> model, Vector nodal_mass, const std::vector<Index>& fixed_nodes = {},
             const std::vector<HeldAxes>& held_axes = {})
      : model_(std::move(model)),
        nodal_mass_(std::move(nodal_mass)),
        numbering_(model_->num_nodes(), fixed_nodes, held_axes),
        pattern_(numbering_, node_dim) {
    require(node_dim == 3 || held_axes.empty(), "nodes with one unknown have no axes to be held along");
    require_size("nodal_mass", nodal_mass_.size(), model_->num_nodes());
    for (Index v = 0; v < nodal_mass_.size(); ++v)
      require(nodal_mass_[v] > 0 && std::isfinite(nodal_mass_[v]), "mass of node " + std::to_string(v) + " is " +
                                                                       shown(nodal_mass_[v]) +
                                                                       ", expected > 0: is it in no component?");
    mass_.resize(dim());
    for (Index f = 0; f < numbering_.num_free(); ++f)
      mass_.segment<node_dim>(f * node_dim).setConstant(nodal_mass_[numbering_.free_nodes()[f]]);
    const Index m = model_->num_components();
    require(m > 0, "the force model has no components");
    std::vector<Index> stencils;
    stencils.reserve(m * Model::stencil_size);
    for (Index i = 0; i < m; ++i) {
      const std::span<const Index, Model::stencil_size> nodes = model_->stencil(i);
      stencils.insert(stencils.end(), nodes.begin(), nodes.end());
    }
    for (Index first = 0; first < m; first += Pack::size) packs_.emplace_back(model_, consecutive_components(first, m));
    stencils_ = std::move(stencils);
    incidence_ = NodeIncidence(stencils_, Model::stencil_size, model_->num_nodes());
    pattern_.build(stencils_, Model::stencil_size, incidence_);
    rest_stiffness_ = pattern_.zero_matrix();
    stiffness(Vector::Zero(dim()), rest_stiffness_);
    if (!numbering_.held_unknowns().empty()) {
      set_supports();
      stiffness(Vector::Zero(dim()), rest_stiffness_);
    }
  }

  Index dim() const { return numbering_.num_free() * node_dim; }
  Index num_nodes() const { return model_->num_nodes(); }
  const Model& model() const { return *model_; }
  const std::shared_ptr<const Model>& shared_model() const { return model_; }
  const NodeNumbering& numbering() const { return numbering_; }
  std::span<const Index> stencils() const { return stencils_; }  ///< stencil_size nodes a component

  const Vector& mass() const { return mass_; }              ///< dim [kg]
  const Vector& nodal_mass() const { return nodal_mass_; }  ///< n [kg]

  double energy(VectorIn u) const requires PotentialModel<Model> {
    const Vector full = expand(u);
    std::vector<double> partial(num_chunks());
    parallel_for(num_chunks(), [&](Index chunk) {
      Pack sum(0.0);
      for_packs(chunk, [&](Index p, int lanes) {
        const Pack e = packs_[p].energy(gather(full, p));
        for (int k = 0; k < lanes; ++k) sum.set(k, sum[k] + e[k]);
      });
      partial[chunk] = sum.sum();
    });
    double total = 0;
    for (const double e : partial) total += e;
    return total + support_energy(u);
  }

  void force(VectorIn u, VectorOut f) const {
    require_size("f", f.size(), dim());
    Vector full(num_nodes() * node_dim);
    full_force(expand(u), full);
    f = restrict(full);
    add_support_force(u, f);
  }
  Vector force(VectorIn u) const {
    Vector f(dim());
    force(u, f);
    return f;
  }

  /// Forces on all nodes, fixed ones too (there, the negative of the reaction), at displacements of all
  /// nodes.
  void full_force(VectorIn u, VectorOut f) const {
    require_size("u", u.size(), num_nodes() * node_dim);
    require_size("f", f.size(), num_nodes() * node_dim);
    sum_forces(f, [&](Index p) { return packs_[p].force(gather(u, p)); });
  }

  /// \see supple::mean_force
  void mean_force(VectorIn u_0, VectorIn u_1, VectorOut f) const {
    require_size("f", f.size(), dim());
    const Vector full_0 = expand(u_0), way = expand(u_1 - u_0);
    Vector full(num_nodes() * node_dim);
    sum_forces(full, [&](Index p) { return mean_force_of(packs_[p], gather(full_0, p), gather(way, p)); });
    f = restrict(full);
    add_support_force(0.5 * (u_0 + u_1), f);
  }

  /// Forces in many states, a column each, dim × k. Eight states at a time go through a component together, whose numbers
  /// are read once: for eight and more, in a fraction of the time of one by one. Equal bits for any num_threads().
  void forces(MatrixIn U, MatrixOut F) const {
    evaluate<false>(U, F, nullptr);
    for (Index k = 0; k < F.cols(); ++k) add_support_force(U.col(k), F.col(k));
  }
  /// And energies, k [J].
  void forces(MatrixIn U, MatrixOut F, VectorOut energies) const requires PotentialModel<Model> {
    require_size("energies", energies.size(), U.cols());
    evaluate<true>(U, F, energies.data());
    for (Index k = 0; k < F.cols(); ++k) {
      add_support_force(U.col(k), F.col(k));
      energies[k] += support_energy(U.col(k));
    }
  }

  /// K becomes the tangent stiffness; its pattern, the same at every call, is set up when K does not have it
  /// yet.
  void stiffness(VectorIn u, SparseMatrix& K) const {
    const Vector full = expand(u);
    sum_tangents(K, [&](Index p) { return packs_[p].stiffness(gather(full, p)); });
    hold(K, 1);
  }
  SparseMatrix stiffness(VectorIn u) const {
    SparseMatrix K = pattern_.zero_matrix();
    stiffness(u, K);
    return K;
  }
  /// \see supple::mean_stiffness
  void mean_stiffness(VectorIn u_0, VectorIn u_1, SparseMatrix& K) const {
    const Vector full_0 = expand(u_0), way = expand(u_1 - u_0);
    sum_tangents(K, [&](Index p) { return mean_stiffness_of(packs_[p], gather(full_0, p), gather(way, p)); });
    hold(K, 0.5);
  }
  const SparseMatrix& rest_stiffness() const { return rest_stiffness_; }

  /// How the neighbourhood of each free node has turned since rest, in each of k states, dim × k. The tangent at u is near
  /// R K(0) Rᵀ, which makes the factor of K(0) a good preconditioner in large deformations (stiffness warping, Müller et al.
  /// 2002).
  std::vector<BlockRotations> frames(MatrixIn U) const requires(node_dim == 3) && requires(const Model& model) {
    model.rest_positions();
  }
  {
    return nodal_frames(model_->rest_positions(), rest_state().expand(U), stencils_, Model::stencil_size, incidence_,
                        numbering_);
  }

  /// What subspaces are made from. Refers to this system.
  RestState rest_state() const {
    static const Points unknown(0, 3);
    const Points* positions = &unknown;
    if constexpr (requires { model_->rest_positions(); }) positions = &model_->rest_positions();
    return {rest_stiffness_,     mass_,      nodal_mass_,
            *positions,          numbering_, stencils_,
            Model::stencil_size, node_dim,   [this](MatrixIn U, MatrixOut F) { forces(U, F); }};
  }
  operator RestState() const { return rest_state(); }

  /// Forces on all nodes, n · node_dim → on the unknowns.
  SystemLoad<SparseMatrix> project(VectorIn nodal_forces) const { return {restrict(nodal_forces), {}}; }
  SystemLoad<SparseMatrix> project(const Loads& loads) const requires(node_dim == 3) {
    check_loads(loads, num_nodes());
    SystemLoad<SparseMatrix> result{Vector::Zero(dim()), {}};
    if (!loads.gravity.isZero(0))
      for (Index f = 0; f < numbering_.num_free(); ++f)
        result.force.segment<3>(3 * f) += nodal_mass_[numbering_.free_nodes()[f]] * loads.gravity;
    for (const NodalForce& load : loads.forces)
      if (const Index f = numbering_.free_index(load.node); f >= 0) result.force.segment<3>(3 * f) += load.force;
    for (const Index i : numbering_.held_unknowns()) result.force[i] = 0;
    add_springs(loads.springs, result);
    result.others = outside_terms(loads.others, numbering_);
    return result;
  }

  /// Unknowns → displacements of all nodes (n · node_dim), zero where fixed.
  Vector expand(VectorIn u) const { return numbering_.expand(u, node_dim); }
  /// Displacement of a node [m], zero where fixed.
  Point displacement(VectorIn u, Index node) const requires(node_dim == 3) {
    const Index f = numbering_.free_index(node);
    if (f < 0) return Point::Zero();
    Point result = u.segment<3>(3 * f);
    for (int c = 0; c < 3; ++c)
      if (is_held(3 * f + c)) result[c] = 0;
    return result;
  }
  /// Values at all nodes → at the unknowns.
  Vector restrict(VectorIn full) const { return numbering_.restrict(full, node_dim); }

 private:
  static constexpr Index packs_per_chunk = 64;

  bool is_held(Index unknown) const { return std::ranges::binary_search(numbering_.held_unknowns(), unknown); }

  /// The springs of held unknowns, and the entries of K that couple them to others. All have the same eigenvalue, above those
  /// of the rest by Gershgorin's theorem for M^-½ K M^-½.
  void set_supports() {
    const std::vector<Index>& held = numbering_.held_unknowns();
    std::vector<char> is_held(static_cast<std::size_t>(dim()), false);
    for (const Index i : held) is_held[static_cast<std::size_t>(i)] = true;
    double bound = 0;
    for (Index j = 0; j < dim(); ++j) {
      double sum = 0;
      for (Index p = rest_stiffness_.outerIndexPtr()[j]; p < rest_stiffness_.outerIndexPtr()[j + 1]; ++p) {
        const Index i = rest_stiffness_.innerIndexPtr()[p];
        if (i == j && is_held[static_cast<std::size_t>(j)])
          held_diagonal_.push_back(p);
        else if (is_held[static_cast<std::size_t>(i)] || is_held[static_cast<std::size_t>(j)])
          uncoupled_.push_back(p);
        else
          sum += std::abs(rest_stiffness_.valuePtr()[p]) / std::sqrt(mass_[i] * mass_[j]);
      }
      bound = std::max(bound, sum);
    }
    support_stiffness_ = (bound > 0 ? bound : 1) * mass_(held);
  }
  /// Takes held unknowns out of K; their springs enter it, times `share`.
  void hold(SparseMatrix& K, double share) const {
    for (const Index p : uncoupled_) K.valuePtr()[p] = 0;
    for (std::size_t k = 0; k < held_diagonal_.size(); ++k)
      K.valuePtr()[held_diagonal_[k]] = share * support_stiffness_[static_cast<Index>(k)];
  }
  void add_support_force(VectorIn u, VectorOut f) const {
    for (Index k = 0; k < support_stiffness_.size(); ++k) {
      const Index i = numbering_.held_unknowns()[static_cast<std::size_t>(k)];
      f[i] += support_stiffness_[k] * u[i];
    }
  }
  double support_energy(VectorIn u) const {
    double sum = 0;
    for (Index k = 0; k < support_stiffness_.size(); ++k) {
      const double displacement = u[numbering_.held_unknowns()[static_cast<std::size_t>(k)]];
      sum += 0.5 * support_stiffness_[k] * displacement * displacement;
    }
    return sum;
  }

  Index num_chunks() const { return (static_cast<Index>(packs_.size()) + packs_per_chunk - 1) / packs_per_chunk; }

  /// body(pack, number of lanes that are real components)
  template <typename Body>
  void for_packs(Index chunk, const Body& body) const {
    const Index end = std::min<Index>(packs_.size(), (chunk + 1) * packs_per_chunk);
    for (Index p = chunk * packs_per_chunk; p < end; ++p)
      body(p, static_cast<int>(std::min<Index>(Pack::size, model_->num_components() - p * Pack::size)));
  }

  using LocalField = Local<Model::local_dofs, Pack>;

  /// f = Σᵢ fᵢ on all nodes. \param force_of  pack of components → their forces.
  template <typename ForceOf>
  void sum_forces(VectorOut f, const ForceOf& force_of) const {
    // one buffer a calling thread, kept: a fresh one would cost as much in page faults as the arithmetic
    static thread_local std::vector<Pack> buffer;
    buffer.resize(packs_.size() * Model::local_dofs);
    Pack* const local = buffer.data();
    parallel_for(num_chunks(), [&](Index chunk) {
      for_packs(chunk, [&](Index p, int) {
        const LocalField f_p = force_of(p);
        std::copy_n(f_p.data(), Model::local_dofs, local + p * Model::local_dofs);
      });
    });
    const double* const values = reinterpret_cast<const double*>(local);
    parallel_ranges(num_nodes(), 4096, [&](Index begin, Index end) {
      for (Index v = begin; v < end; ++v) {
        Local<node_dim> sum = Local<node_dim>::Zero();
        for (const Index slot : incidence_.of(v)) {  // slot = component · stencil_size + corner
          const Index i = slot / Model::stencil_size, corner = slot % Model::stencil_size;
          const double* at =
              values + ((i / Pack::size) * Model::local_dofs + corner * node_dim) * Pack::size + i % Pack::size;
          for (int c = 0; c < node_dim; ++c) sum[c] += at[c * Pack::size];
        }
        f.template segment<node_dim>(v * node_dim) = sum;
      }
    });
  }

  /// K = Σᵢ Kᵢ. \param tangent_of  pack of components → their Kᵢ.
  template <typename TangentOf>
  void sum_tangents(SparseMatrix& K, const TangentOf& tangent_of) const {
    if (K.rows() != dim() || K.nonZeros() != pattern_.num_nonzeros()) K = pattern_.zero_matrix();
    double* const values = K.valuePtr();
    std::fill_n(values, K.nonZeros(), 0.0);
    constexpr Index local_size = Model::local_dofs * Model::local_dofs;
    constexpr Index chunks_at_once = 16;  // bounds the buffer, whatever the size of the mesh
    std::vector<Pack> buffer(std::min(chunks_at_once, num_chunks()) * packs_per_chunk * local_size);
    const int owners = num_threads();
    for (Index first = 0; first < num_chunks(); first += chunks_at_once) {
      const Index last = std::min(num_chunks(), first + chunks_at_once);
      parallel_for(last - first, [&](Index c) {
        for_packs(first + c, [&](Index p, int) {
          const LocalMatrix<Model::local_dofs, Pack> K_p = tangent_of(p);
          std::copy_n(K_p.data(), local_size, buffer.data() + (p - first * packs_per_chunk) * local_size);
        });
      });
      const Index begin = first * packs_per_chunk * Pack::size;
      const Index end = std::min<Index>(model_->num_components(), last * packs_per_chunk * Pack::size);
      parallel_for(owners, [&](Index owner) {  // each adds to its own columns, in order of components
        pattern_.scatter(owner, owners, begin, end, reinterpret_cast<const double*>(buffer.data()), values);
      });
    }
  }

  void add_springs(const std::vector<PointSpring>& springs, SystemLoad<SparseMatrix>& load) const {
    const Index count = 3 * static_cast<Index>(springs.size());
    SystemSprings<SparseMatrix> sum{SparseMatrix(count, dim()), Vector(count), Vector(count)};
    std::vector<Eigen::Triplet<double>> rows, diagonal;
    for (Index row = 0; const PointSpring& spring : springs) {
      const Index f = numbering_.free_index(spring.node);  // held nodes do not move, their rows stay empty
      for (int c = 0; c < 3; ++c, ++row) {
        sum.stiffness[row] = spring.stiffness;
        sum.targets[row] = spring.displacement[c];
        if (f < 0 || is_held(3 * f + c)) continue;
        rows.emplace_back(row, 3 * f + c, 1);
        diagonal.emplace_back(3 * f + c, 3 * f + c, spring.stiffness);
      }
    }
    if (diagonal.empty()) return;
    sum.rows.setFromTriplets(rows.begin(), rows.end());
    load.stiffness.resize(dim(), dim());
    load.stiffness.setFromTriplets(diagonal.begin(), diagonal.end());
    load.force += sum.pull_of_targets();
    load.springs = std::move(sum);
  }

  template <bool with_energies>
  void evaluate(MatrixIn U, MatrixOut F, double* energies) const {
    require_size("U.rows()", U.rows(), dim());
    require_size("F.rows()", F.rows(), dim());
    require_size("F.cols()", F.cols(), U.cols());
    constexpr Index pieces = 2;  // sums that are kept apart, whatever the number of threads
    const Index m = model_->num_components(), unknowns = num_nodes() * node_dim;
    static thread_local std::vector<Pack> buffer;  // of a calling thread, kept: see full_force()
    buffer.resize((1 + pieces) * unknowns);
    Pack* const u = buffer.data();
    const auto sums = [&](Index piece) { return u + (1 + piece) * unknowns; };
    for (Index first = 0; first < U.cols(); first += Pack::size) {
      const Index count = std::min<Index>(Pack::size, U.cols() - first);
      for (const Index v : numbering_.fixed_nodes()) std::fill_n(u + v * node_dim, node_dim, Pack(0.0));
      for (int k = 0; k < Pack::size; ++k) {  // lanes past the end repeat the last state
        const double* const from = U.col(first + std::min<Index>(k, count - 1)).data();
        for (Index v = 0; v < numbering_.num_free(); ++v)
          for (int c = 0; c < node_dim; ++c)
            u[numbering_.free_nodes()[v] * node_dim + c].set(k, from[v * node_dim + c]);
      }
      for (const Index i : numbering_.held_unknowns()) u[3 * numbering_.free_nodes()[i / 3] + i % 3] = Pack(0.0);
      std::array<Pack, pieces> e;
      parallel_for(pieces, [&](Index piece) {
        Pack* const f = sums(piece);
        std::fill_n(f, unknowns, Pack(0.0));
        Pack sum(0.0);
        const Index end = m * (piece + 1) / pieces;
        for (Index i = m * piece / pieces; i < end; ++i) {
          const Index* const soon = stencils_.data() + std::min(i + 6, end - 1) * Model::stencil_size;
          for (int a = 0; a < Model::stencil_size; ++a)
            for (int c = 0; c < node_dim; ++c) {
              __builtin_prefetch(u + soon[a] * node_dim + c);
              __builtin_prefetch(f + soon[a] * node_dim + c, 1);
            }
          const TermPack<Model> term(model_, i);
          const Index* nodes = stencils_.data() + i * Model::stencil_size;
          Local<Model::local_dofs, Pack> u_i;
          for (int a = 0; a < Model::stencil_size; ++a)
            for (int c = 0; c < node_dim; ++c) u_i[a * node_dim + c] = u[nodes[a] * node_dim + c];
          const Local<Model::local_dofs, Pack> f_i = term.force(u_i);
          for (int a = 0; a < Model::stencil_size; ++a)
            for (int c = 0; c < node_dim; ++c) f[nodes[a] * node_dim + c] += f_i[a * node_dim + c];
          if constexpr (with_energies) sum += term.energy(u_i);
        }
        e[piece] = sum;
      });
      for (int k = 0; k < count; ++k) {
        double* const to = F.col(first + k).data();
        for (Index v = 0; v < numbering_.num_free(); ++v)
          for (int c = 0; c < node_dim; ++c) {
            const Index row = numbering_.free_nodes()[v] * node_dim + c;
            to[v * node_dim + c] = sums(0)[row][k] + sums(1)[row][k];
          }
        for (const Index i : numbering_.held_unknowns()) to[i] = 0;
        if constexpr (with_energies) energies[first + k] = e[0][k] + e[1][k];
      }
    }
  }

  Local<Model::local_dofs, Pack> gather(VectorIn full, Index p) const {
    Local<Model::local_dofs, Pack> u;
    const PackIndices lanes = consecutive_components(p * Pack::size, model_->num_components());
    for (int k = 0; k < Pack::size; ++k) {
      const Index* nodes = stencils_.data() + lanes[k] * Model::stencil_size;
      for (int a = 0; a < Model::stencil_size; ++a)
        for (int c = 0; c < node_dim; ++c) u[a * node_dim + c].set(k, full[nodes[a] * node_dim + c]);
    }
    return u;
  }

  std::shared_ptr<const Model> model_;
  Vector nodal_mass_;
  NodeNumbering numbering_;
  Vector mass_;
  std::vector<TermPack<Model>> packs_;
  std::vector<Index> stencils_;
  NodeIncidence incidence_;
  NodeBlockPattern pattern_;
  SparseMatrix rest_stiffness_;
  Vector support_stiffness_;                      // of held unknowns [N/m]
  std::vector<Index> held_diagonal_, uncoupled_;  // places of theirs among the values of K
};

}  // namespace supple
