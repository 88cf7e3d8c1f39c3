// SubspaceBuilder: operator()(object) must return a Subspace, such as a DenseBasis or a NodalBasis
#include <reduction/subspace/explain_subspace_builder.hpp>

using namespace supple;

struct RandomBasis {
  Matrix operator()(const RestState& object) const;
};
static_assert(explain_subspace_builder<RandomBasis>());
