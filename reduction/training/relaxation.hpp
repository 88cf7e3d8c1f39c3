#pragma once
/// \file States of the full object beside those of a subspace: what reduced forces are fitted to, and what reduced
/// equilibria are judged by.

#include <numerics/linear/block_rotations.hpp>
#include <numerics/linear/cholmod_solver.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/subspace/subspace_columns.hpp>
#include <reduction/system/reduced_modes.hpp>

#include <functional>
#include <memory>
#include <vector>

namespace supple {

/// States u_t of a full object as a subspace sees them, a column each.
struct FullStates {
  Matrix Q;           ///< d × T, Uᵀ M u: the nearest states of the subspace
  Matrix forces;      ///< d × T, Uᵀ f(u): what the full object answers there
  Vector energies;    ///< T, E(u) [J]
  Vector sizes;       ///< T, ‖u‖_M [kg^½ m]
  Vector outside;     ///< T, ‖u − U q‖_M / ‖u‖_M: what no state of the subspace has
  Matrix remainders;  ///< dim × T, u − U q over the free unknowns [m]
  Vector residuals;   ///< T, ‖Δu‖_M / ‖u‖_M of the last step: about how far from its end the search is
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
class Relaxation {
 public:
  /// \param modes  of the reduced stiffness at rest. \throws SolverError if K(0) is not positive semi-definite.
  template <PotentialModel Model, Subspace S>
  Relaxation(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace,
             const ReducedModes& modes)
      : Relaxation(object(std::move(system), std::move(subspace)), modes) {}

  /// \param Q  d × T. \param iterations  each comes closer to the least energy; few are enough, for the first steps bring
  /// most of it.
  FullStates relaxed(const Matrix& Q, Index iterations = 4) const;

  /// \param loads  Λ, d × T. What has no energy is held by springs as stiff as the softest flexible mode, as in
  /// equilibrium_poses(). \param start  d × T, such as reduced equilibria. \param tolerance  of the last step, as a share of
  /// the way from the start, so that what is said of the start is right to that share.
  FullStates equilibria(const Matrix& loads, const Matrix& start, double tolerance = 0.03,
                        Index max_iterations = 40) const;

 private:
  /// A full object and a subspace of it, over the free unknowns, whatever their types: many states at once, a column each.
  struct Object {
    const SparseMatrix& K;  // at rest
    const Vector& mass;
    std::function<void(MatrixIn U, MatrixOut F, VectorOut energies)> forces;
    std::function<std::vector<BlockRotations>(MatrixIn U)> frames;
    std::function<Matrix(MatrixIn Q)> lift;     // U Q
    std::function<Matrix(MatrixIn F)> project;  // Uᵀ F
  };
  template <PotentialModel Model, Subspace S>
  static Object object(std::shared_ptr<const FullSystem<Model>> system, std::shared_ptr<const S> subspace) {
    return {system->rest_stiffness(),
            system->mass(),
            [system](MatrixIn U, MatrixOut F, VectorOut energies) { system->forces(U, F, energies); },
            [system](MatrixIn U) {
              if constexpr (requires { system->frames(U); })
                return system->frames(U);
              else
                return std::vector<BlockRotations>(U.cols());
            },
            [system, subspace](MatrixIn Q) -> Matrix {
              return system->rest_state().restrict(reconstruct_columns(*subspace, Q));
            },
            [system, subspace](MatrixIn F) -> Matrix {
              return project_columns(*subspace, Matrix(system->rest_state().expand(F)));
            }};
  }
  Relaxation(Object object, const ReducedModes& modes);

  struct Search;
  struct Run;
  struct Evaluated;
  using Searches = std::vector<Search*>;

  FullStates run(const Matrix& start, const Matrix& loads, double tolerance, Index max_iterations) const;
  std::vector<Search> minimise(const Matrix& start, const Run& run) const;
  bool is_near_end(const Run& run, const Search& search) const;
  void turn(const Searches& searches) const;
  void find_steps(const Run& run, const Searches& searches) const;
  void advance(const Run& run, Searches searches) const;
  Evaluated evaluate(const Run& run, const Searches& searches, const Matrix& U) const;
  double size(VectorIn u) const;

  Object object_;
  Matrix rigid_;  // motions without energy, dim × num_zero
  double spring_;
  CholmodSolver cholesky_;
};

}  // namespace supple
