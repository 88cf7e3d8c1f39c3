#pragma once
/// \file Objective of any kind, its type erased.

#include <numerics/optimize/objective.hpp>

namespace supple {

/// Any SmoothObjective behind one interface, so that solvers are compiled once for each type of matrix.
template <typename Matrix_>
class AnyObjective {
 public:
  using MatrixType = Matrix_;

  virtual ~AnyObjective() = default;
  virtual bool has_value() const = 0;
  virtual double value(VectorIn u) = 0;
  virtual void gradient(VectorIn u, VectorOut g) = 0;
  virtual void hessian(VectorIn u, MatrixType& H) = 0;
  virtual void rest_hessian(MatrixType& H) = 0;
  virtual double scale(VectorIn u) = 0;
  virtual const Vector& metric() const = 0;
  virtual BlockRotations frames(VectorIn u) const = 0;
};

static_assert(SmoothObjective<AnyObjective<Matrix>> && SmoothObjective<AnyObjective<SparseMatrix>>);

/// \param objective  must outlive this.
template <SmoothObjective O>
class ErasedObjective final : public AnyObjective<typename O::MatrixType> {
 public:
  explicit ErasedObjective(O& objective) : own_(objective) {}

  bool has_value() const override { return supple::has_value(own_); }
  double value(VectorIn u) override { return own_.value(u); }
  void gradient(VectorIn u, VectorOut g) override { own_.gradient(u, g); }
  void hessian(VectorIn u, typename O::MatrixType& H) override { own_.hessian(u, H); }
  void rest_hessian(typename O::MatrixType& H) override { supple::rest_hessian(own_, H); }
  double scale(VectorIn u) override { return own_.scale(u); }
  const Vector& metric() const override { return own_.metric(); }
  BlockRotations frames(VectorIn u) const override { return frames_of(own_, u); }

 private:
  O& own_;
};

}  // namespace supple
