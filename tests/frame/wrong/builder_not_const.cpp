// SubspaceBuilder: operator()(system) must be const
#include <reduction/subspace/explain_subspace_builder.hpp>

using namespace supple;

struct RandomBasis {
  template <DynamicalSystem S>
  DenseBasis operator()(const S& system);
};
static_assert(explain_subspace_builder<RandomBasis>());
