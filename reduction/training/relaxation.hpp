#pragma once
/// \file States of the full object beside those of a subspace: what reduced forces are fitted to, and what reduced
/// equilibria are judged by.

#include <numerics/linear/cholmod_solver.hpp>
#include <numerics/linear/matrix_sums.hpp>
#include <numerics/optimize/bfgs_memory.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/subspace/subspace_columns.hpp>
#include <reduction/system/reduced_modes.hpp>

#include <cmath>
#include <concepts>
#include <vector>

namespace supple {

/// States u_t of a full object as a subspace sees them, a column each.
struct FullStates {
  Matrix Q;          ///< d × T, Uᵀ M u: the nearest states of the subspace
  Matrix forces;     ///< d × T, Uᵀ f(u): what the full object answers there
  Vector energies;   ///< T, E(u) [J]
  Vector sizes;      ///< T, ‖u‖_M [kg^½ m]
  Vector outside;    ///< T, ‖u − U q‖_M / ‖u‖_M: what no state of the subspace has
  Vector residuals;  ///< T, ‖Δu‖_M / ‖u‖_M of the last step: about how far from its end the search is
};

/// A full object whose displacements outside of a subspace relax: minimises E(u) from many reduced states at once,
///   relaxed(Q):             u = U q + w, UᵀM w = 0, over w (the static condensation of a nonlinear object);
///   equilibria(Λ, start):   E(u) − (M U λ)ᵀ u, over all u.
/// A subspace holds an object tight: states of it miss small stiff corrections, and their forces are too large. What the
/// object answers once these corrections have followed is Uᵀ f(u), the gradient of the relaxed energy over q (implicit
/// condensation, Hollkamp & Gordon 2008).
///
/// By the L-BFGS method, eight states at once, whose first inverse Hessian is R K⁻¹ Rᵀ: one factorisation at rest under
/// the rotations of the nodes at each eighth iterate (stiffness warping, Müller et al. 2002). None is factorised for deformed
/// states. Equal bits for any num_threads().
template <ForceModel Model, Subspace S>
class Relaxation {
  static_assert(PotentialModel<Model>, "relaxation needs forces with a potential");

 public:
  /// \param modes  of the reduced stiffness at rest. \throws SolverError if K(0) is not positive semi-definite.
  Relaxation(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace,
             const ReducedModes& modes)
      : system_(std::move(system)),
        subspace_(std::move(subspace)),
        rigid_(modes.Phi.leftCols(modes.num_zero)),
        spring_(modes.num_zero > 0 ? modes.softest_stiffness() : 0) {
    cholesky_.analyze(system_->rest_stiffness());
    // motions without energy that the subspace lacks show as a factorisation that fails
    for (const double shift : {0.5 * spring_, 1e-3 * modes.softest_stiffness()}) {
      SparseMatrix K = system_->rest_stiffness();
      add_diagonal(K, shift * system_->mass());
      if (cholesky_.factorize(K)) return;
    }
    throw SolverError("relaxation: K is not positive semi-definite at rest");
  }

  /// \param Q  d × T. \param iterations  each comes closer to the least energy; few are enough, for the first steps bring
  /// most of it.
  FullStates relaxed(const Matrix& Q, Index iterations = 4) const { return run(Q, {}, 1e-6, iterations); }

  /// \param loads  Λ, d × T. What has no energy is held by springs as stiff as the softest flexible mode, as in
  /// equilibrium_poses(). \param start  d × T, such as reduced equilibria. \param tolerance  of the last step, as a share of
  /// the way from the start, so that what is said of the start is right to that share.
  FullStates equilibria(const Matrix& loads, const Matrix& start, double tolerance = 0.03,
                        Index max_iterations = 40) const {
    require_size("start.cols()", start.cols(), loads.cols());
    return run(start, loads, tolerance, max_iterations);
  }

 private:
  /// One minimisation on its way. Everything over the free unknowns.
  struct Search {
    Index load;
    Vector start, u = start, gradient = {}, step = {};
    double value = 0, residual = 0;
    BlockRotations frames = {};
    BfgsMemory memory{8};
    bool ended = false;
  };
  using Searches = std::vector<Search*>;
  struct Run {
    Matrix loads;  // M U λ, dim × count, or empty: then u keeps its part in the subspace
    double tolerance;
    Index max_iterations;
    bool in_complement() const { return loads.size() == 0; }
  };

  FullStates run(const Matrix& start, const Matrix& loads, double tolerance, Index max_iterations) const {
    const Index d = subspace_->dim(), T = start.cols();
    FullStates states{Matrix(d, T), Matrix(d, T), Vector(T), Vector(T), Vector(T), Vector(T)};
    constexpr Index at_once = 8;  // columns for which the solver reads its factor once
    for (Index begin = 0; begin < T; begin += at_once) {
      const Index count = std::min(at_once, T - begin);
      Run run{{}, tolerance, max_iterations};
      if (loads.size() > 0) run.loads = system_->mass().asDiagonal() * lift(loads.middleCols(begin, count));
      const std::vector<Search> ends = minimise(lift(start.middleCols(begin, count)), run);
      Matrix U(system_->dim(), count), f = U;
      for (Index k = 0; k < count; ++k) U.col(k) = ends[k].u;
      system_->forces(U, f, states.energies.segment(begin, count));
      const Matrix Q = project(system_->mass().asDiagonal() * U);
      const Matrix outside = U - lift(Q);
      states.Q.middleCols(begin, count) = Q;
      states.forces.middleCols(begin, count) = project(f);
      for (Index k = 0; k < count; ++k) {
        states.sizes[begin + k] = size(ends[k].u);
        states.outside[begin + k] = size(outside.col(k)) / states.sizes[begin + k];
        states.residuals[begin + k] = ends[k].residual;
      }
    }
    return states;
  }

  std::vector<Search> minimise(const Matrix& start, const Run& run) const {
    std::vector<Search> all;
    Searches going;
    for (Index k = 0; k < start.cols(); ++k) all.push_back({k, start.col(k)});
    for (Search& search : all) going.push_back(&search);
    const Evaluated at_start = evaluate(run, going, start);
    for (Search& search : all) at_start.give(search.load, search);
    for (Index iteration = 0; !going.empty(); ++iteration) {
      if (iteration % turned_every == 0) turn(going);
      find_steps(run, going);
      for (Search* search : going) search->ended = is_near_end(run, *search) || iteration == run.max_iterations;
      std::erase_if(going, [](const Search* search) { return search->ended; });
      advance(run, going);
      std::erase_if(going, [](const Search* search) { return search->ended; });
    }
    return all;
  }

  bool is_near_end(const Run& run, const Search& search) const {
    return !(search.residual > 1e-12 && size(search.step) > run.tolerance * size(search.u - search.start));
  }

  void turn(const Searches& searches) const {
    if constexpr (requires(MatrixIn U) { system_->frames(U); }) {
      Matrix U(system_->dim(), searches.size());
      for (Index k = 0; k < U.cols(); ++k) U.col(k) = searches[k]->u;
      std::vector<BlockRotations> frames = system_->frames(U);
      for (Index k = 0; k < U.cols(); ++k) searches[k]->frames = std::move(frames[k]);
    }
  }

  void find_steps(const Run& run, const Searches& searches) const {
    const auto count = static_cast<Index>(searches.size());
    Matrix G(system_->dim(), count);
    std::vector<std::vector<double>> coefficients(count);  // of the first loops of the memories
    parallel_for(count, [&](Index k) {
      Vector g = searches[k]->gradient;
      coefficients[k] = searches[k]->memory.first_loop(g);
      G.col(k) = g;
    });
    if (run.in_complement()) G -= system_->mass().asDiagonal() * lift(project(G));
    parallel_for(count, [&](Index k) { searches[k]->frames.turn_back(G.col(k)); });
    cholesky_.solve(G, G);
    parallel_for(count, [&](Index k) { searches[k]->frames.turn(G.col(k)); });
    if (run.in_complement()) G -= lift(project(system_->mass().asDiagonal() * G));
    parallel_for(count, [&](Index k) {
      Search& search = *searches[k];
      search.step = G.col(k);
      search.memory.second_loop(coefficients[k], search.step);
      search.step = -search.step;
      search.residual = size(search.step) / size(search.u);
    });
  }

  /// Goes along the steps as far as the potentials decrease; ends searches whose potential does not.
  void advance(const Run& run, Searches searches) const {
    for (double t = 1; !searches.empty() && t > 1e-6; t *= 0.5) {
      Matrix trials(system_->dim(), searches.size());
      for (Index k = 0; k < trials.cols(); ++k) trials.col(k) = searches[k]->u + t * searches[k]->step;
      const Evaluated there = evaluate(run, searches, trials);
      Searches rejected;
      for (Index k = 0; k < trials.cols(); ++k) {
        Search& search = *searches[k];
        const double slope = search.gradient.dot(search.step), rounding = 1e-13 * std::abs(search.value);
        if (slope < 0 && there.values[k] <= search.value + 1e-4 * t * slope + rounding) {
          search.memory.add(trials.col(k) - search.u, there.gradients.col(k) - search.gradient);
          search.u = trials.col(k);
          there.give(k, search);
        } else {
          rejected.push_back(&search);
        }
      }
      searches = std::move(rejected);
    }
    for (Search* search : searches) {
      search->ended = search->memory.size() == 0;
      search->memory.clear();  // once more along the preconditioned gradient
    }
  }

  /// Potentials, and their gradients, in states of some searches.
  struct Evaluated {
    Vector values;
    Matrix gradients;
    void give(Index k, Search& search) const {
      search.value = values[k];
      search.gradient = gradients.col(k);
    }
  };
  Evaluated evaluate(const Run& run, const Searches& searches, const Matrix& U) const {
    Evaluated result{Vector(U.cols()), Matrix(U.rows(), U.cols())};
    system_->forces(U, result.gradients, result.values);
    if (run.in_complement()) return result;
    for (Index k = 0; k < U.cols(); ++k) {
      const auto load = run.loads.col(searches[k]->load);
      result.values[k] -= load.dot(U.col(k));
      result.gradients.col(k) -= load;
    }
    if (spring_ > 0) {
      const Matrix held = rigid_ * (rigid_.transpose() * project(system_->mass().asDiagonal() * U));
      result.values += 0.5 * spring_ * held.colwise().squaredNorm().transpose();
      result.gradients += spring_ * (system_->mass().asDiagonal() * lift(held));
    }
    return result;
  }

  static constexpr Index turned_every = 8;  // iterations; frames hardly change in between

  double size(VectorIn u) const { return std::sqrt(u.cwiseAbs2().dot(system_->mass())); }
  Matrix lift(MatrixIn Q) const { return system_->rest_state().restrict(reconstruct_columns(*subspace_, Q)); }
  Matrix project(MatrixIn F) const { return project_columns(*subspace_, Matrix(system_->rest_state().expand(F))); }

  std::shared_ptr<const FullSystem<Model>> system_;
  std::shared_ptr<const S> subspace_;
  Matrix rigid_;  // d × num_zero
  double spring_;
  CholmodSolver cholesky_;
};

}  // namespace supple
