#include <reduction/basis/modal_basis.hpp>
#include <reduction/system/reduced_modes.hpp>
#include <reduction/system/reduced_system.hpp>
#include <reduction/system/stiffness_range.hpp>
#include <tests/support/bars.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

// All components are the exact stiffness, halved weights half of it, whether the object is held or free.
TEST(StiffnessRange, FollowsTheWeights) {
  for (const StvkBar& bar : {clamped_bar(), free_bar()}) {
    const auto basis = std::make_shared<const NodalBasis>(ExtendedModalBasis{.num_modes = 8}(bar));
    const Matrix exact = project_stiffness(*basis, bar);
    const ReducedModes modes = reduced_modes(exact);
    const Index m = bar.model().num_components();
    const auto range = [&](const Vector& w) {
      const ReducedSystem system(bar.shared_model(), basis, all_components(m), w, exact, bar.nodal_mass());
      return stiffness_range(system.stiffness(Vector::Zero(basis->dim())), modes);
    };
    const StiffnessRange all = range(Vector::Ones(m)), half = range(Vector::Constant(m, 0.5));
    EXPECT_NEAR(all.smallest, 1, 1e-6);
    EXPECT_NEAR(all.largest, 1, 1e-6);
    EXPECT_TRUE(all.is_sound());
    EXPECT_NEAR(half.smallest, 0.5, 1e-6);
    EXPECT_NEAR(half.largest, 0.5, 1e-6);
    EXPECT_FALSE(half.is_sound());
    EXPECT_NEAR(half.points_for_sound(90), 150, 1);  // 0.5 is to become 0.3
  }
}

// One direction that is wrong is found, however stiff it is; motions without energy are not asked.
TEST(StiffnessRange, IsThatOfTheWorstDirections) {
  ReducedModes exact{Vector::LinSpaced(5, 0, 4), Matrix::Identity(5, 5), 1};
  Matrix stiffness = exact.omega.cwiseAbs2().asDiagonal();
  stiffness(0, 0) = 7;
  stiffness(2, 2) *= 1.25;
  stiffness(4, 4) *= 0.2;
  const StiffnessRange range = stiffness_range(stiffness, exact);
  EXPECT_NEAR(range.smallest, 0.2, 1e-12);
  EXPECT_NEAR(range.largest, 1.25, 1e-12);
  exact.num_zero = 5;
  EXPECT_TRUE(std::isnan(stiffness_range(stiffness, exact).largest));
}

}  // namespace
}  // namespace supple::test
