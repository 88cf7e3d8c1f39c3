// SubspaceBuilder: operator()(system) must return a Subspace: a DenseBasis or a NodalBasis
#include <reduction/subspace/explain_subspace_builder.hpp>

using namespace supple;

struct RandomBasis {
  template <DynamicalSystem S>
  Matrix operator()(const S& system) const;
};
static_assert(explain_subspace_builder<RandomBasis>());
