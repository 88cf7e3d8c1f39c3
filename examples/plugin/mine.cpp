// One of each kind that commands know by name, all from outside the tree: docs/plugins.md.
#include <reduction/plugin/plugin.hpp>

#include <batched_omp.hpp>
#include <gent.hpp>
#include <midpoint.hpp>
#include <polynomial_basis.hpp>
#include <spring_tets.hpp>
#include <wind.hpp>

SUPPLE_PLUGIN(registry) {
  registry.add(make_material_law<Gent>("gent"));
  registry.add(spring_tets());
  registry.add(named_selector("batched-omp", "several of all columns at a time",
                              OptionsOf<BatchedOmp>().add("batch", &BatchedOmp::batch, "columns in each round")));
  registry.add(named_subspace("polynomials", "polynomials of the rest positions",
                              OptionsOf<PolynomialBasis>().add("degree", &PolynomialBasis::degree, "at most")));
  registry.add(named_integrator<Midpoint>("midpoint", "implicit midpoint rule", OptionsOf<MidpointParameters>()));
  registry.add(named_outside_force(
      "wind", "a steady wind on the surface",
      OptionsOf<WindParameters>()
          .add("x", &WindParameters::x, "of the air [m/s]")
          .add("y", &WindParameters::y, "of the air [m/s]")
          .add("z", &WindParameters::z, "of the air [m/s]")
          .add("density", &WindParameters::density, "of the air [kg/m^3]"),
      [](const TouchedNodes& where, const WindParameters& parameters) { return Wind(where, parameters); }));
}
