// Which elements lock where a material hardly changes its volume, by the bending of a bar.

#include <numerics/eigen/eigensolver.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/locking.hpp>
#include <physics/body/material_law.hpp>
#include <physics/system/full_system.hpp>
#include <tests/support/meshes.hpp>
#include <tests/support/solids.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <string>

namespace supple::test {
namespace {

constexpr double length = 1, height = 0.125, young = 1e5, beam_density = 1000;

/// Softest frequency of a body [rad/s].
double softest(const Body& body) {
  return with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const FullSystem<Model> system(model, nodal_mass(body), fixed_nodes(body));
    EigenOptions options;
    options.num_modes = 1;
    options.tolerance = 1e-8;
    const EigenPairs pairs =
        smallest_eigenpairs(system.rest_stiffness(), system.mass(), Matrix(system.dim(), 0), options);
    return std::sqrt(pairs.omega_squared[0]);
  });
}

/// A bar of 16 × 2 × 2 boxes of cells, clamped at one end.
template <typename Element>
Body bar(double poisson, const std::string& law = "stvk") {
  const auto mesh = box_of<Element>({16, 2, 2}, length / 16);
  std::vector<Index> end;
  for (Index v = 0; v < mesh.num_nodes(); ++v)
    if (mesh.nodes(v, 0) < 1e-9) end.push_back(v);
  return isotropic_solid(mesh, {.young = young, .poisson = poisson}, std::move(end), law, beam_density);
}

/// Of a clamped slender beam, (1.8751 / l)² √(E I / ρ A): whatever Poisson's ratio is.
double beam() {
  return std::pow(1.87510407 / length, 2) * std::sqrt(young * height * height / 12 / beam_density);
}

TEST(Locking, IsOfLinearTetsAndHexahedraOnly) {
  for (const double poisson : {0.3, 0.45, 0.49, 0.4999}) {
    SCOPED_TRACE(poisson);
    const double quadratic = softest(bar<QuadraticTet>(poisson)), hexahedra = softest(bar<TrilinearHex>(poisson)),
                 tets = softest(bar<LinearTet>(poisson));
    EXPECT_NEAR(quadratic, beam(), 0.04 * beam());
    EXPECT_GT(tets, hexahedra);
    if (poisson == 0.3) {
      EXPECT_LT(hexahedra, 1.1 * beam());
    }
    if (poisson == 0.4999) {
      EXPECT_GT(tets, 2 * beam());
      EXPECT_GT(hexahedra, 2 * beam());
    }
  }
}

/// Of a law made from moduli. Fibres of Fung's are twice as stiff, which adds 2 μ E_ff² / 2: 2 μ / 9 to the bulk modulus, and
/// (2 μ − 2 μ / 3) / 10 to the mean shear modulus.
double poisson_of(const std::string& law, double poisson) {
  const IsotropicModuli moduli{.poisson = poisson};
  if (law != "fung") return poisson;
  const double bulk = moduli.bulk() + moduli.shear() * 2 / 9, shear = moduli.shear() * (1 + 2.0 / 15);
  return (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear);
}

TEST(Locking, IsSaidWherePoissonsRatioIsAbove045) {
  for (const std::string& law : material_laws()) {
    SCOPED_TRACE(law);
    for (const double poisson : {0.46, 0.4999}) {
      const auto tets = locking_poisson(bar<LinearTet>(poisson, law)),
                 hexahedra = locking_poisson(bar<TrilinearHex>(poisson, law));
      ASSERT_TRUE(tets && hexahedra);
      EXPECT_NEAR(*tets, poisson_of(law, poisson), 1e-9);
      EXPECT_NEAR(*hexahedra, poisson_of(law, poisson), 1e-9);
      EXPECT_FALSE(locking_poisson(bar<QuadraticTet>(poisson, law)));
    }
    for (const double poisson : {-0.3, 0.0, 0.4, 0.45}) {
      EXPECT_FALSE(locking_poisson(bar<LinearTet>(poisson, law)));
      EXPECT_NEAR(material_law(law).poisson(material_law(law).from({.young = 3e5, .poisson = poisson})),
                  poisson_of(law, poisson), 1e-9);
    }
  }
  const Shell shell = isotropic_shell(equilateral_grid(3, 3, 0.1), {.young = 1e5, .poisson = 0.49}, 0.01);
  EXPECT_FALSE(locking_poisson(shell));
}

// Parameters say it, not the moduli that they replaced: one material of two, one bulk modulus.
TEST(Locking, IsThatOfTheParameters) {
  Solid solid = std::get<Solid>(bar<LinearTet>(0.3, "mooney-rivlin"));
  solid.parameters.conservativeResize(2, Eigen::NoChange);
  solid.parameters.row(1) = solid.parameters.row(0);
  solid.material_of_cell.assign(solid.mesh.num_cells(), 0);
  solid.material_of_cell.back() = 1;
  EXPECT_FALSE(locking_poisson(solid));
  const double mu = 2 * (solid.parameters(1, 0) + solid.parameters(1, 1)), bulk = 300 * mu;
  solid.parameters(1, 2) = bulk;
  ASSERT_TRUE(locking_poisson(solid));
  EXPECT_NEAR(*locking_poisson(solid), (3 * bulk - 2 * mu) / (6 * bulk + 2 * mu), 1e-12);
}

}  // namespace
}  // namespace supple::test
