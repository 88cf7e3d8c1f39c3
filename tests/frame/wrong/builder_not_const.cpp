// SubspaceBuilder: operator()(object) must be const
#include <reduction/subspace/explain_subspace_builder.hpp>

using namespace supple;

struct RandomBasis {
  DenseBasis operator()(const RestState& object);
};
static_assert(explain_subspace_builder<RandomBasis>());
