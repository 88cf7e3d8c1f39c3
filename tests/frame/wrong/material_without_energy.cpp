// Material: `Real energy(const Matrix3<Real>& F) const` is missing
#include <physics/model/tet_elasticity.hpp>

using namespace supple;

template <typename Real>
struct Tissue {
  Real mu;
  Matrix3<Real> stress(const Matrix3<Real>& F) const;
};

TetElasticity<Tissue> model(const TetMesh& mesh) {
  return {mesh, Tissue<double>{1e5}};
}
