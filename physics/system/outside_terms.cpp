#include <physics/system/outside_terms.hpp>

#include <algorithm>
#include <utility>

namespace supple {

namespace {

class FullTerm final : public OutsideTerm<SparseMatrix> {
 public:
  FullTerm(AnyOutsideForce force, const NodeNumbering& numbering) : force_(std::move(force)) {
    for (const Index v : force_.nodes()) free_.push_back(numbering.free_index(v));
    for (std::size_t a = 0; a < free_.size(); ++a)
      for (int c = 0; c < 3; ++c)
        if (free_[a] >= 0 && std::ranges::binary_search(numbering.held_unknowns(), 3 * free_[a] + c))
          held_.push_back({static_cast<Index>(a), c});
  }

  void add_force(VectorIn u, VectorOut f) const override {
    Points at_nodes = Points::Zero(num_nodes(), 3);
    force_.force(displacements(u), at_nodes);
    require_size("the outside force", at_nodes.rows(), num_nodes());
    for (const auto& [a, c] : held_) at_nodes(a, c) = 0;
    for (Index a = 0; a < num_nodes(); ++a)
      if (free_[a] >= 0) f.segment<3>(3 * free_[a]) += at_nodes.row(a).transpose();
  }
  void add_stiffness(VectorIn u, SparseMatrix& K) const override {
    ForceGradient gradient;
    force_.stiffness(displacements(u), gradient);
    for (auto [a, b, block] : gradient.blocks()) {
      if (free_[a] < 0 || free_[b] < 0) continue;
      for (const auto& [node, c] : held_) {
        if (node == a) block.row(c).setZero();
        if (node == b) block.col(c).setZero();
      }
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          K.coeffRef(3 * free_[a] + i, 3 * free_[b] + j) += 0.5 * block(i, j);
          K.coeffRef(3 * free_[b] + j, 3 * free_[a] + i) += 0.5 * block(i, j);
        }
    }
    K.makeCompressed();
  }
  double potential(VectorIn u) const override { return force_.potential(displacements(u)); }
  bool has_potential() const override { return force_.has_potential(); }

 private:
  Index num_nodes() const { return static_cast<Index>(free_.size()); }
  Points displacements(VectorIn u) const {
    Points at_nodes = Points::Zero(num_nodes(), 3);
    for (Index a = 0; a < num_nodes(); ++a)
      if (free_[a] >= 0) at_nodes.row(a) = u.segment<3>(3 * free_[a]).transpose();
    for (const auto& [a, c] : held_) at_nodes(a, c) = 0;
    return at_nodes;
  }

  AnyOutsideForce force_;
  std::vector<Index> free_;                  // −1 where fixed
  std::vector<std::pair<Index, int>> held_;  // positions in nodes() and axes that supports hold
};

}  // namespace

std::vector<std::shared_ptr<const OutsideTerm<SparseMatrix>>> outside_terms(const std::vector<AnyOutsideForce>& forces,
                                                                            const NodeNumbering& numbering) {
  std::vector<std::shared_ptr<const OutsideTerm<SparseMatrix>>> terms;
  for (const AnyOutsideForce& force : forces) terms.push_back(std::make_shared<const FullTerm>(force, numbering));
  return terms;
}

}  // namespace supple
