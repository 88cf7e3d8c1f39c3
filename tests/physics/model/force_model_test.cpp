#include <physics/material/corotational.hpp>
#include <physics/material/fung.hpp>
#include <physics/material/neo_hookean.hpp>
#include <physics/material/ogden.hpp>
#include <testing/force_model_conformance.hpp>
#include <tests/support/force_models.hpp>

namespace supple::test {

INSTANTIATE_TYPED_TEST_SUITE_P(StVenantKirchhoffTets, ForceModelConformance, TetBar<StVenantKirchhoff>);
INSTANTIATE_TYPED_TEST_SUITE_P(MooneyRivlinTets, ForceModelConformance, TetBar<MooneyRivlin>);
INSTANTIATE_TYPED_TEST_SUITE_P(NeoHookeanTets, ForceModelConformance, TetBar<NeoHookean>);
INSTANTIATE_TYPED_TEST_SUITE_P(StableNeoHookeanTets, ForceModelConformance, TetBar<StableNeoHookean>);
INSTANTIATE_TYPED_TEST_SUITE_P(CorotationalTets, ForceModelConformance, TetBar<Corotational>);
INSTANTIATE_TYPED_TEST_SUITE_P(OgdenTets, ForceModelConformance, TetBar<Ogden>);
INSTANTIATE_TYPED_TEST_SUITE_P(FungTets, ForceModelConformance, TetBar<Fung>);
INSTANTIATE_TYPED_TEST_SUITE_P(TetsOfAnyLaw, ForceModelConformance, AnyTets);
INSTANTIATE_TYPED_TEST_SUITE_P(FlatShell, ForceModelConformance, FlatShell);
INSTANTIATE_TYPED_TEST_SUITE_P(ClosedShell, ForceModelConformance, ClosedShell);
INSTANTIATE_TYPED_TEST_SUITE_P(CurvedShell, ForceModelConformance, CurvedShell);
INSTANTIATE_TYPED_TEST_SUITE_P(LinearHeat, ForceModelConformance, HeatBar<LinearConductivity>);
INSTANTIATE_TYPED_TEST_SUITE_P(ExponentialHeat, ForceModelConformance, HeatBar<ExponentialConductivity>);
INSTANTIATE_TYPED_TEST_SUITE_P(HotSurface, ForceModelConformance, HotSurface);
INSTANTIATE_TYPED_TEST_SUITE_P(CoolingBar, ForceModelConformance, CoolingBar);
INSTANTIATE_TYPED_TEST_SUITE_P(Springs, ForceModelConformance, SpringBar);
INSTANTIATE_TYPED_TEST_SUITE_P(Oscillators, ForceModelConformance, DuffingSet);

static_assert(PackableForceModel<TetElasticity<MooneyRivlin>> && !PackableForceModel<SpringNetwork>);

}  // namespace supple::test
