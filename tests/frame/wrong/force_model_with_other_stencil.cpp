// ForceModel: `stencil(i)` must be const and return std::span<const Index, stencil_size>
#include <physics/system/full_system.hpp>

using namespace supple;

struct Springs {
  static constexpr int stencil_size = 2;
  static constexpr int node_dim = 3;
  static constexpr int local_dofs = 6;
  Index num_nodes() const;
  Index num_components() const;
  std::span<const Index, 3> stencil(Index i) const;
  double energy(Index i, const Local<6>& u_i) const;
  Local<6> force(Index i, const Local<6>& u_i) const;
  LocalMatrix<6> stiffness(Index i, const Local<6>& u_i) const;
};

FullSystem<Springs> make(Springs springs, Vector mass) {
  return {springs, mass};
}
