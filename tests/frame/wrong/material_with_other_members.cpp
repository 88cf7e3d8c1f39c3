// Material: its members must be of type Real (or arrays of them) and nothing else
#include <physics/model/tet_elasticity.hpp>

using namespace supple;

template <typename Real>
struct Tissue {
  double mu;
  Real energy(const Matrix3<Real>& F) const;
  Matrix3<Real> stress(const Matrix3<Real>& F) const;
};

TetElasticity<Tissue> model(const TetMesh& mesh) {
  return {mesh, Tissue<double>{1e5}};
}
