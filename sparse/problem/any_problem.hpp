#pragma once
/// \file Fitting problem whose type is known at run time only, so that selectors chosen by name compile
/// once.

#include <sparse/problem/fitting_problem.hpp>

#include <memory>

namespace supple {

/// Evaluated columns of an AnyProblem; a ColumnBlock.
class AnyColumns {
 public:
  template <typename C>
  requires(!std::same_as<C, AnyColumns> && ColumnBlock<C>) AnyColumns(C columns)
      : self_(std::make_unique<Model<C>>(std::move(columns))) {}

  Index size() const { return self_->size(); }
  Index index(Index k) const { return self_->index(k); }
  Vector times(VectorIn w) const { return self_->times(w); }
  Vector transpose_times(VectorIn r) const { return self_->transpose_times(r); }
  Matrix gram(const AnyColumns& other) const { return self_->gram(*other.self_); }
  Vector squared_norms() const { return self_->squared_norms(); }
  AnyColumns subset(std::span<const Index> positions) const { return AnyColumns(self_->subset(positions)); }
  void append(const AnyColumns& other) { self_->append(*other.self_); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual Index size() const = 0;
    virtual Index index(Index k) const = 0;
    virtual Vector times(VectorIn w) const = 0;
    virtual Vector transpose_times(VectorIn r) const = 0;
    virtual Matrix gram(const Interface& other) const = 0;
    virtual Vector squared_norms() const = 0;
    virtual std::unique_ptr<Interface> subset(std::span<const Index> positions) const = 0;
    virtual void append(const Interface& other) = 0;
  };
  template <typename C>
  struct Model final : Interface {
    explicit Model(C c) : columns(std::move(c)) {}
    Index size() const override { return columns.size(); }
    Index index(Index k) const override { return columns.index(k); }
    Vector times(VectorIn w) const override { return columns.times(w); }
    Vector transpose_times(VectorIn r) const override { return columns.transpose_times(r); }
    Matrix gram(const Interface& other) const override {
      return columns.gram(static_cast<const Model&>(other).columns);
    }
    Vector squared_norms() const override { return columns.squared_norms(); }
    std::unique_ptr<Interface> subset(std::span<const Index> positions) const override {
      return std::make_unique<Model>(columns.subset(positions));
    }
    void append(const Interface& other) override { columns.append(static_cast<const Model&>(other).columns); }
    C columns;
  };

  explicit AnyColumns(std::unique_ptr<Interface> self) : self_(std::move(self)) {}

  std::unique_ptr<Interface> self_;
};
static_assert(ColumnBlock<AnyColumns>);

/// Refers to a problem that must outlive it.
class AnyProblem {
 public:
  template <typename P>
  requires(FullGradientProblem<P>&& GroupedFittingProblem<P> &&
           !std::same_as<P, AnyProblem>) explicit AnyProblem(const P& problem)
      : self_(std::make_shared<Model<P>>(problem)) {}

  Index rows() const { return self_->rows(); }
  Index cols() const { return self_->cols(); }
  const Vector& rhs() const { return self_->rhs(); }
  void column(Index j, VectorOut out) const { self_->column(j, out); }
  AnyColumns columns(std::span<const Index> js) const { return self_->columns(js); }
  Index numbers_per_column() const { return self_->numbers_per_column(); }
  Vector transpose_times(VectorIn r) const { return self_->transpose_times(r); }
  Vector squared_norms() const { return self_->squared_norms(); }
  Index num_groups() const { return self_->num_groups(); }
  AnyProblem restricted_to(std::span<const Index> groups) const { return AnyProblem(self_->restricted_to(groups)); }

 private:
  struct Interface {
    virtual ~Interface() = default;
    virtual Index rows() const = 0;
    virtual Index cols() const = 0;
    virtual const Vector& rhs() const = 0;
    virtual void column(Index j, VectorOut out) const = 0;
    virtual AnyColumns columns(std::span<const Index> js) const = 0;
    virtual Index numbers_per_column() const = 0;
    virtual Vector transpose_times(VectorIn r) const = 0;
    virtual Vector squared_norms() const = 0;
    virtual Index num_groups() const = 0;
    virtual std::shared_ptr<const Interface> restricted_to(std::span<const Index> groups) const = 0;
  };
  template <typename P>
  struct Model final : Interface {
    explicit Model(const P& p) : problem(&p) {}
    explicit Model(P&& p) : owned(std::make_unique<P>(std::move(p))), problem(owned.get()) {}
    Index rows() const override { return problem->rows(); }
    Index cols() const override { return problem->cols(); }
    const Vector& rhs() const override { return problem->rhs(); }
    void column(Index j, VectorOut out) const override { problem->column(j, out); }
    AnyColumns columns(std::span<const Index> js) const override { return AnyColumns(columns_of(*problem, js)); }
    Index numbers_per_column() const override { return supple::numbers_per_column(*problem); }
    Vector transpose_times(VectorIn r) const override { return problem->transpose_times(r); }
    Vector squared_norms() const override { return problem->squared_norms(); }
    Index num_groups() const override { return problem->num_groups(); }
    std::shared_ptr<const Interface> restricted_to(std::span<const Index> groups) const override {
      auto restricted = problem->restricted_to(groups);
      return std::make_shared<Model<decltype(restricted)>>(std::move(restricted));
    }
    std::unique_ptr<P> owned;
    const P* problem;
  };

  explicit AnyProblem(std::shared_ptr<const Interface> self) : self_(std::move(self)) {}

  std::shared_ptr<const Interface> self_;
};
static_assert(BlockFittingProblem<AnyProblem> && FullGradientProblem<AnyProblem> && GroupedFittingProblem<AnyProblem>);

}  // namespace supple
