#pragma once
/// \file System of an object in ℝ³, full or reduced, its type erased: a value.

#include <numerics/linear/block_rotations.hpp>
#include <physics/system/dynamical_system.hpp>
#include <physics/system/mean_force.hpp>

#include <memory>
#include <utility>
#include <vector>

namespace supple {

/// A DynamicalSystem that knows the displacements of its nodes.
template <typename S>
concept ObjectSystem = DynamicalSystem<S> && requires(const S& system, VectorIn u, Index node) {
  { system.num_nodes() } -> std::convertible_to<Index>;            // n
  { system.expand(u) } -> std::convertible_to<Vector>;             // unknowns → displacements of all nodes, 3n [m]
  { system.displacement(u, node) } -> std::convertible_to<Point>;  // of one of them [m]
};

/// Any ObjectSystem behind one type, so that what runs it is compiled once; a value to keep and pass on, copies share the
/// system. Costs one virtual call an evaluation.
template <typename Matrix_>
class AnySystem {
 public:
  using MatrixType = Matrix_;
  static constexpr bool symmetric_tangent = true;

  template <ObjectSystem System>
  requires(std::same_as<typename System::MatrixType, MatrixType>) explicit AnySystem(
      std::shared_ptr<const System> system)
      : system_(std::make_shared<const Of<System>>(std::move(system))) {}

  Index dim() const { return system_->dim(); }
  const Vector& mass() const { return system_->mass(); }                          ///< dim [kg]
  const MatrixType& rest_stiffness() const { return system_->rest_stiffness(); }  ///< K(0)
  double energy(VectorIn u) const { return system_->energy(u); }                  ///< [J]
  void force(VectorIn u, VectorOut f) const { system_->force(u, f); }             ///< [N]
  void stiffness(VectorIn u, MatrixType& K) const { system_->stiffness(u, K); }   ///< [N/m]
  /// \see supple::mean_force
  void mean_force(VectorIn u_0, VectorIn u_1, VectorOut f) const { system_->mean_force(u_0, u_1, f); }
  void mean_stiffness(VectorIn u_0, VectorIn u_1, MatrixType& K) const { system_->mean_stiffness(u_0, u_1, K); }
  Vector force(VectorIn u) const {
    Vector f(dim());
    force(u, f);
    return f;
  }
  MatrixType stiffness(VectorIn u) const {
    MatrixType K;
    stiffness(u, K);
    return K;
  }
  /// Loads on nodes → on the unknowns.
  SystemLoad<MatrixType> project(const Loads& loads) const { return system_->project(loads); }

  Index num_nodes() const { return system_->num_nodes(); }
  /// Unknowns → displacements of all nodes, 3n [m].
  Vector expand(VectorIn u) const { return system_->expand(u); }
  /// Displacement of a node [m].
  Point displacement(VectorIn u, Index node) const { return system_->displacement(u, node); }
  /// How its nodes have turned since rest, of each of k states, dim × k; of full systems, others say that nothing has.
  std::vector<BlockRotations> frames(MatrixIn U) const { return system_->frames(U); }

 private:
  class Interface {
   public:
    virtual ~Interface() = default;
    virtual Index dim() const = 0;
    virtual const Vector& mass() const = 0;
    virtual const MatrixType& rest_stiffness() const = 0;
    virtual double energy(VectorIn u) const = 0;
    virtual void force(VectorIn u, VectorOut f) const = 0;
    virtual void stiffness(VectorIn u, MatrixType& K) const = 0;
    virtual void mean_force(VectorIn u_0, VectorIn u_1, VectorOut f) const = 0;
    virtual void mean_stiffness(VectorIn u_0, VectorIn u_1, MatrixType& K) const = 0;
    virtual SystemLoad<MatrixType> project(const Loads& loads) const = 0;
    virtual Index num_nodes() const = 0;
    virtual Vector expand(VectorIn u) const = 0;
    virtual Point displacement(VectorIn u, Index node) const = 0;
    virtual std::vector<BlockRotations> frames(MatrixIn U) const = 0;
  };
  template <typename System>
  class Of final : public Interface {
   public:
    explicit Of(std::shared_ptr<const System> system) : own_(std::move(system)) {}
    Index dim() const override { return own_->dim(); }
    const Vector& mass() const override { return own_->mass(); }
    const MatrixType& rest_stiffness() const override { return own_->rest_stiffness(); }
    double energy(VectorIn u) const override { return own_->energy(u); }
    void force(VectorIn u, VectorOut f) const override { own_->force(u, f); }
    void stiffness(VectorIn u, MatrixType& K) const override { own_->stiffness(u, K); }
    void mean_force(VectorIn u_0, VectorIn u_1, VectorOut f) const override { supple::mean_force(*own_, u_0, u_1, f); }
    void mean_stiffness(VectorIn u_0, VectorIn u_1, MatrixType& K) const override {
      supple::mean_stiffness(*own_, u_0, u_1, K);
    }
    SystemLoad<MatrixType> project(const Loads& loads) const override { return own_->project(loads); }
    Index num_nodes() const override { return own_->num_nodes(); }
    Vector expand(VectorIn u) const override { return own_->expand(u); }
    Point displacement(VectorIn u, Index node) const override { return own_->displacement(u, node); }
    std::vector<BlockRotations> frames(MatrixIn U) const override {
      if constexpr (requires { own_->frames(U); })
        return own_->frames(U);
      else
        return std::vector<BlockRotations>(U.cols());
    }

   private:
    std::shared_ptr<const System> own_;
  };

  std::shared_ptr<const Interface> system_;
};

static_assert(ObjectSystem<AnySystem<Matrix>> && ObjectSystem<AnySystem<SparseMatrix>>);

}  // namespace supple
