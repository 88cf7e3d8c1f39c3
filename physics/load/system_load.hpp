#pragma once
/// \file Load on a system, in its unknowns.

#include <core/check.hpp>
#include <numerics/linear/matrix_sums.hpp>
#include <physics/load/outside_force.hpp>

#include <memory>
#include <vector>

namespace supple {

/// An outside force in the unknowns of a system. Adding is all it does, for several act together.
template <typename MatrixType>
class OutsideTerm {
 public:
  virtual ~OutsideTerm() = default;
  virtual void add_force(VectorIn u, VectorOut f) const = 0;        ///< f += f_ext(u)
  virtual void add_stiffness(VectorIn u, MatrixType& K) const = 0;  ///< K −= ∂f_ext/∂u, symmetric part
  virtual double potential(VectorIn u) const = 0;                   ///< V, 0 without one
  virtual bool has_potential() const = 0;
};

/// f_ext(u) = force − stiffness u + Σ others(u), in the unknowns of a system; what is absent costs nothing. Integrators
/// and static solvers see −f_ext as a constant part, `force`, and a pull that depends on u and counts as the forces of
/// the object do.
template <typename MatrixType>
struct SystemLoad {
  Vector force;
  MatrixType stiffness;  ///< of springs; without entries it stands for zero
  std::vector<std::shared_ptr<const OutsideTerm<MatrixType>>> others = {};

  bool has_stiffness() const { return stiffness.size() > 0; }
  bool has_pull() const { return has_stiffness() || !others.empty(); }
  bool has_potential() const {
    for (const auto& other : others)
      if (!other->has_potential()) return false;
    return true;
  }

  /// result += stiffness u − Σ others(u).
  void add_pull(VectorIn u, VectorOut result) const {
    if (has_stiffness()) result += stiffness * u;
    if (others.empty()) return;
    Vector sum = Vector::Zero(u.size());
    for (const auto& other : others) other->add_force(u, sum);
    result -= sum;
  }
  /// The potential of the pull [J].
  double pull_energy(VectorIn u) const {
    double sum = has_stiffness() ? 0.5 * u.dot(stiffness * u) : 0.0;
    for (const auto& other : others) sum += other->potential(u);
    return sum;
  }
  /// K += the derivative of the pull.
  void add_stiffness(VectorIn u, MatrixType& K) const {
    if (has_stiffness()) add_few(K, stiffness);
    for (const auto& other : others) other->add_stiffness(u, K);
  }
  /// Whether tangents are those under another load: the same springs and others, wherever they pull to.
  bool has_same_pull(const SystemLoad& load) const { return equal(stiffness, load.stiffness) && others == load.others; }
  /// f_ext(u).
  Vector at(VectorIn u) const {
    Vector f = force;
    if (!has_pull()) return f;
    Vector pull = Vector::Zero(u.size());
    add_pull(u, pull);
    return f - pull;
  }

  /// \throws std::invalid_argument for sizes that are not those of a system of `dim` unknowns.
  void check(Index dim) const {
    require_size("load.force", force.size(), dim);
    if (has_stiffness()) require_size("load.stiffness", stiffness.rows(), dim);
  }
};

/// What acts as time passes: a load that stays, or a function of time [s]; what it gives lasts until it is called again.
template <typename L, typename MatrixType>
concept LoadOverTime = std::convertible_to < const L&,
        const SystemLoad<MatrixType>
& > || requires(const L& load, double t) {
  { load(t) } -> std::convertible_to<const SystemLoad<MatrixType>&>;
};

}  // namespace supple
