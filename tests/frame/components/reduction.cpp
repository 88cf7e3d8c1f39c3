// The mode of a mass on three springs: ω = √(k/m).
#include <physics/model/spring_model.hpp>
#include <physics/system/full_system.hpp>
#include <reduction/basis/modal_basis.hpp>

using namespace supple;

int main() {
  Points nodes(4, 3);
  nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1;
  const FullSystem system(SpringModel(nodes, {{0, 1}, {0, 2}, {0, 3}}, /*stiffness=*/100), Vector::Ones(4), {1, 2, 3});
  const DenseBasis basis = ModalBasis{.num_modes = 1}(system);
  return std::abs(basis.report.omega[0] - 10) < 1e-8 ? 0 : 1;
}
