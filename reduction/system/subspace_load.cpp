#include <reduction/system/subspace_load.hpp>

namespace supple {

namespace {

/// An outside force through the rows of the basis at its nodes, kept together.
template <int block>
class ReducedTerm final : public OutsideTerm<Matrix> {
 public:
  ReducedTerm(AnyOutsideForce force, const RowMatrix& W) : force_(std::move(force)) {
    constexpr Index rows_of_node = 3 / block;
    const std::span<const Index> nodes = force_.nodes();
    rows_.W.resize(rows_of_node * static_cast<Index>(nodes.size()), W.cols());
    for (Index a = 0; a < num_nodes(); ++a)
      rows_.W.middleRows(rows_of_node * a, rows_of_node) =
          W.middleRows(rows_of_node * nodes[static_cast<std::size_t>(a)], rows_of_node);
  }

  void add_force(VectorIn q, VectorOut f) const override {
    Points at_nodes = Points::Zero(num_nodes(), 3);
    force_.force(displacements(q), at_nodes);
    require_size("the outside force", at_nodes.rows(), num_nodes());
    f += rows_.project(at_nodes.reshaped<Eigen::RowMajor>());
  }
  void add_stiffness(VectorIn q, Matrix& K) const override {
    ForceGradient gradient;
    force_.stiffness(displacements(q), gradient);
    if (gradient.blocks().empty()) return;
    const Matrix U = rows_.dense();
    Matrix KU = Matrix::Zero(U.rows(), U.cols());
    for (const auto& [a, b, of_nodes] : gradient.blocks())
      KU.middleRows<3>(3 * a).noalias() += of_nodes * U.middleRows<3>(3 * b);
    const Matrix reduced = U.transpose() * KU;
    K += 0.5 * (reduced + reduced.transpose());
  }
  double potential(VectorIn q) const override { return force_.potential(displacements(q)); }
  bool has_potential() const override { return force_.has_potential(); }

 private:
  Index num_nodes() const { return static_cast<Index>(force_.nodes().size()); }
  Points displacements(VectorIn q) const {
    const Vector u = rows_.reconstruct(q);
    return Eigen::Map<const RowMatrix>(u.data(), num_nodes(), 3);
  }

  AnyOutsideForce force_;
  KroneckerBasis<block> rows_;
};

}  // namespace

std::vector<std::shared_ptr<const OutsideTerm<Matrix>>> outside_terms(const std::vector<AnyOutsideForce>& forces,
                                                                      const RowMatrix& W, int block) {
  std::vector<std::shared_ptr<const OutsideTerm<Matrix>>> terms;
  for (const AnyOutsideForce& force : forces)
    terms.push_back(block == 3 ? std::shared_ptr<const OutsideTerm<Matrix>>(std::make_shared<ReducedTerm<3>>(force, W))
                               : std::make_shared<ReducedTerm<1>>(force, W));
  return terms;
}

}  // namespace supple
