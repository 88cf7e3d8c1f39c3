#include <physics/time/generalized_alpha.hpp>
#include <physics/time/integrator_library.hpp>
#include <physics/time/newmark.hpp>

namespace supple {

Registry<NamedIntegrator>& integrators() {
  static Registry<NamedIntegrator> all(
      "integrator",
      {named_integrator<Newmark>(
           "newmark", "Newmark's family; as it stands, average acceleration",
           OptionsOf<NewmarkParameters>()
               .add("beta", &NewmarkParameters::beta, "share of the acceleration at the end of a step in displacements")
               .add("gamma", &NewmarkParameters::gamma, "the same in velocities; above 0.5 damps, at first order")),
       named_integrator<GeneralizedAlpha>(
           "generalized-alpha", "second order, and what is too fast for the step dies out",
           OptionsOf<GeneralizedAlphaParameters>().add("rho_infinity", &GeneralizedAlphaParameters::rho_infinity,
                                                       "what a step leaves of infinitely fast motions, 0 to 1"))});
  return all;
}

AnyIntegrator<AnySystem<Matrix>> make_integrator(const Choice& choice, const AnySystem<Matrix>& system, double h,
                                                 const StepOptions& step) {
  return integrators().at(choice.name).reduced(system, h, step, choice.options);
}
AnyIntegrator<AnySystem<SparseMatrix>> make_integrator(const Choice& choice, const AnySystem<SparseMatrix>& system,
                                                       double h, const StepOptions& step) {
  return integrators().at(choice.name).full(system, h, step, choice.options);
}

}  // namespace supple
