#include <testing/dynamical_system_conformance.hpp>
#include <tests/support/force_models.hpp>

namespace supple::test {

template <typename Factory>
using Systems = testing::Types<FullSystemOf<Factory, false>, FullSystemOf<Factory, true>>;  // free, fixed

INSTANTIATE_TYPED_TEST_SUITE_P(StVenantKirchhoffTets, DynamicalSystemConformance, Systems<TetBar<StVenantKirchhoff>>);
INSTANTIATE_TYPED_TEST_SUITE_P(MooneyRivlinTets, DynamicalSystemConformance, Systems<TetBar<MooneyRivlin>>);
INSTANTIATE_TYPED_TEST_SUITE_P(Springs, DynamicalSystemConformance, Systems<SpringBar>);
INSTANTIATE_TYPED_TEST_SUITE_P(Oscillators, DynamicalSystemConformance, Systems<DuffingSet>);

}  // namespace supple::test
