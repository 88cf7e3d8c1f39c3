// Material: there is a `stress`, but not `Matrix3<Real> stress(const Matrix3<Real>& F) const`
#include <physics/model/tet_elasticity.hpp>

using namespace supple;

template <typename Real>
struct Tissue {
  Real mu;
  Real energy(const Matrix3<Real>& F) const;
  Real stress(const Matrix3<Real>& F) const;
};

TetElasticity<Tissue> model(const TetMesh& mesh) {
  return {mesh, Tissue<double>{1e5}};
}
