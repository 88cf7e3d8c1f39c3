#pragma once
/// \file Forces from outside as a seam: wind, obstacles, pressure, your own.

#include <core/types.hpp>

#include <concepts>
#include <memory>
#include <span>
#include <vector>

namespace supple {

/// −∂f/∂u of an outside force, as blocks over the nodes that it touches.
class ForceGradient {
 public:
  struct Block {
    Index a, b;         ///< positions in nodes()
    Matrix3<double> K;  ///< −∂f_a/∂u_b [N/m]
  };
  void add(Index a, Index b, const Matrix3<double>& K) { blocks_.push_back({a, b, K}); }
  const std::vector<Block>& blocks() const { return blocks_; }

 private:
  std::vector<Block> blocks_;
};

/// What acts on an object beside its own sum of terms: a force on some nodes that depends on where they are. It sees the
/// displacements u of nodes(), k × 3 [m], and is never part of what a selection replaces: a reduced system evaluates it
/// on the rows of the basis that it touches.
///
/// It also promises, and supple::testing checks: nodes distinct; const calls safe from several threads; with a
/// potential, f = −∂V/∂u; with a stiffness, its blocks are −∂f/∂u.
template <typename F>
concept OutsideForce = requires(const F& outside, const Points& u, Points& f) {
  { outside.nodes() } -> std::convertible_to<std::span<const Index>>;  // k, those it touches
  outside.force(u, f);                                                 // f, k × 3 [N]
};

/// An outside force with a potential: steps are minimisers, and energy is accounted for.
template <typename F>
concept PotentialOutsideForce = OutsideForce<F> && requires(const F& outside, const Points& u) {
  { outside.potential(u) } -> std::convertible_to<double>;  // V [J]
};

/// An outside force that knows its derivative: without, Newton's method converges as fast as the force is soft.
template <typename F>
concept StiffOutsideForce = OutsideForce<F> && requires(const F& outside, const Points& u, ForceGradient& K) {
  outside.stiffness(u, K);  // blocks −∂f/∂u [N/m]; their symmetric part is used
};

/// Any OutsideForce, its type erased: a value, copies share the force.
class AnyOutsideForce {
 public:
  template <OutsideForce F>
  requires(!std::same_as<F, AnyOutsideForce>)
      AnyOutsideForce(F force)  // NOLINT(google-explicit-constructor): a Loads takes any force as it is
      : force_(std::make_shared<const Of<F>>(std::move(force))) {}

  std::span<const Index> nodes() const { return force_->nodes(); }
  void force(const Points& u, Points& f) const { force_->force(u, f); }
  bool has_potential() const { return force_->has_potential(); }
  /// Whether it is a load that may grow in steps and holds nothing, as a pressure does, by `static constexpr bool is_load`; a
  /// floor is none.
  bool is_load() const { return force_->is_load(); }
  double potential(const Points& u) const { return force_->potential(u); }  ///< 0 without one
  void stiffness(const Points& u, ForceGradient& K) const { force_->stiffness(u, K); }

 private:
  class Interface {
   public:
    virtual ~Interface() = default;
    virtual std::span<const Index> nodes() const = 0;
    virtual void force(const Points& u, Points& f) const = 0;
    virtual bool has_potential() const = 0;
    virtual bool is_load() const = 0;
    virtual double potential(const Points& u) const = 0;
    virtual void stiffness(const Points& u, ForceGradient& K) const = 0;
  };
  template <typename F>
  class Of final : public Interface {
   public:
    explicit Of(F force) : own_(std::move(force)) {}
    std::span<const Index> nodes() const override { return own_.nodes(); }
    void force(const Points& u, Points& f) const override { own_.force(u, f); }
    bool has_potential() const override { return PotentialOutsideForce<F>; }
    bool is_load() const override {
      if constexpr (requires { F::is_load; })
        return F::is_load;
      else
        return false;
    }
    double potential(const Points& u) const override {
      if constexpr (PotentialOutsideForce<F>)
        return own_.potential(u);
      else
        return 0;
    }
    void stiffness(const Points& u, ForceGradient& K) const override {
      if constexpr (StiffOutsideForce<F>) own_.stiffness(u, K);
    }

   private:
    F own_;
  };

  std::shared_ptr<const Interface> force_;
};

}  // namespace supple
