#include <testing/force_model_conformance.hpp>
#include <tests/support/solids.hpp>

namespace supple::test {

constexpr SolidComponent by_element = SolidComponent::Element, by_point = SolidComponent::GaussPoint;
using TetBars =
    testing::Types<CellBar<LinearTet, StVenantKirchhoff, by_point>, CellBar<LinearTet, MooneyRivlin, by_point>>;
using HexBars =
    testing::Types<CellBar<TrilinearHex, StVenantKirchhoff, by_element>,
                   CellBar<TrilinearHex, MooneyRivlin, by_element>, CellBar<TrilinearHex, StVenantKirchhoff, by_point>,
                   CellBar<TrilinearHex, MooneyRivlin, by_point>>;
using QuadraticTetBars =
    testing::Types<CellBar<QuadraticTet, StVenantKirchhoff, by_element>,
                   CellBar<QuadraticTet, MooneyRivlin, by_element>, CellBar<QuadraticTet, StVenantKirchhoff, by_point>,
                   CellBar<QuadraticTet, MooneyRivlin, by_point>>;

INSTANTIATE_TYPED_TEST_SUITE_P(Tets, ForceModelConformance, TetBars);
INSTANTIATE_TYPED_TEST_SUITE_P(Hexes, ForceModelConformance, HexBars);
INSTANTIATE_TYPED_TEST_SUITE_P(QuadraticTets, ForceModelConformance, QuadraticTetBars);

}  // namespace supple::test
