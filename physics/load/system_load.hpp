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

/// Springs ½ Σ kᵢ (B u − t)ᵢ² in the unknowns of a system, three rows for each point that one holds. Stiff ones hold it
/// nearly at its target, and k B u and k t nearly cancel; this knows their difference.
template <typename MatrixType>
struct SystemSprings {
  MatrixType rows;   ///< B: unknowns → displacements of the points
  Vector stiffness;  ///< k [N/m]
  Vector targets;    ///< t [m]

  bool empty() const { return targets.size() == 0; }
  /// Bᵀ k (B u − t): minus the force on the unknowns.
  Vector pull(VectorIn u) const { return rows.transpose() * stiffness.cwiseProduct(rows * u - targets); }
  /// Bᵀ k t: their force at u = 0.
  Vector pull_of_targets() const { return rows.transpose() * stiffness.cwiseProduct(targets); }
  double energy(VectorIn u) const {
    const Vector stretch = rows * u - targets;
    return 0.5 * stretch.dot(stiffness.cwiseProduct(stretch));
  }
};

/// f_ext(u) = force − stiffness u + Σ others(u), in the unknowns of a system; what is absent costs nothing. To
/// solvers −f_ext is a constant part and a pull that depends on u and counts as the forces of the object do. Those who judge
/// residuals ask how much of both is springs: they tell dead forces from the net pull.
template <typename MatrixType>
struct SystemLoad {
  Vector force;
  MatrixType stiffness;  ///< of springs; without entries it stands for zero
  std::vector<std::shared_ptr<const OutsideTerm<MatrixType>>> others = {};
  /// The springs whose Bᵀ k t is a part of `force` and whose Bᵀ k B is `stiffness`. Empty where nobody tells: `force` is then
  /// all dead, and springs pull to u = 0.
  SystemSprings<MatrixType> springs = {};

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
    subtract_others(u, result);
  }
  /// The potential of the pull [J].
  double pull_energy(VectorIn u) const {
    return (has_stiffness() ? 0.5 * u.dot(stiffness * u) : 0.0) + potential_of_others(u);
  }
  /// What of `force` no spring exerts.
  Vector dead_force() const { return springs.empty() ? force : Vector(force - springs.pull_of_targets()); }
  /// result += what springs and others exert together, the other sign: −f_ext(u) = net pull − dead force.
  void add_net_pull(VectorIn u, VectorOut result) const {
    if (springs.empty()) return add_pull(u, result);
    result += springs.pull(u);
    subtract_others(u, result);
  }
  /// The potential of the net pull [J]: of springs, how far they are from their targets.
  double net_pull_energy(VectorIn u) const {
    if (springs.empty()) return pull_energy(u);
    return springs.energy(u) + potential_of_others(u);
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
    if (springs.empty()) return;
    require_size("load.springs.rows", springs.rows.cols(), dim);
    require_size("load.springs.stiffness", springs.stiffness.size(), springs.targets.size());
    require_size("load.springs.targets", springs.targets.size(), springs.rows.rows());
  }

 private:
  void subtract_others(VectorIn u, VectorOut result) const {
    if (others.empty()) return;
    Vector sum = Vector::Zero(u.size());
    for (const auto& other : others) other->add_force(u, sum);
    result -= sum;
  }
  double potential_of_others(VectorIn u) const {
    double sum = 0;
    for (const auto& other : others) sum += other->potential(u);
    return sum;
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
