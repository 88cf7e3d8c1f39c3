#include <physics/time/average_vector_field.hpp>
#include <physics/time/backward_difference.hpp>
#include <physics/time/generalized_alpha.hpp>
#include <physics/time/integrator_library.hpp>
#include <physics/time/newmark.hpp>

namespace supple {

namespace {

/// One node that nothing holds and no force moves: enough to make an integrator.
struct NodeAtRest {
  using MatrixType = Matrix;
  Vector ones = Vector::Ones(3);
  Matrix K = Matrix::Zero(3, 3);

  Index dim() const { return 3; }
  const Vector& mass() const { return ones; }
  double energy(VectorIn) const { return 0; }
  void force(VectorIn, VectorOut f) const { f.setZero(); }
  void stiffness(VectorIn, Matrix& tangent) const { tangent = K; }
  const Matrix& rest_stiffness() const { return K; }
  SystemLoad<Matrix> project(const Loads&) const { return {Vector::Zero(3), {}}; }
  Index num_nodes() const { return 1; }
  Vector expand(VectorIn u) const { return u; }
  Point displacement(VectorIn u, Index) const { return u; }
};

}  // namespace

EnergyBehaviour energy_behaviour(const Choice& choice) {
  const AnySystem<Matrix> system(std::make_shared<const NodeAtRest>());
  return make_integrator(choice, system, 1, {}).energy_behaviour();
}

Registry<NamedIntegrator>& integrators() {
  static Registry<NamedIntegrator> all(
      "integrator",
      {named_integrator<AverageVectorField>("average-vector-field",
                                            "second order, keeps the energy of large deformations",
                                            OptionsOf<AverageVectorFieldParameters>()),
       named_integrator<Newmark>(
           "newmark", "Newmark's family; as it stands, average acceleration",
           OptionsOf<NewmarkParameters>()
               .add("beta", &NewmarkParameters::beta, "share of the acceleration at the end of a step in displacements")
               .add("gamma", &NewmarkParameters::gamma,
                    "the same in velocities; above 0.5, with beta = (gamma + 0.5)^2 / 4, it damps, at first order")),
       named_integrator<GeneralizedAlpha>(
           "generalized-alpha", "second order, and what is too fast for the step dies out",
           OptionsOf<GeneralizedAlphaParameters>().add("rho_infinity", &GeneralizedAlphaParameters::rho_infinity,
                                                       "what a step leaves of infinitely fast motions, 0 to 1")),
       named_integrator<TrBdf2>("tr-bdf2", "second order, damps what is fast for good; two solves a step",
                                OptionsOf<BackwardDifferenceParameters>()),
       named_integrator<Bdf2>("bdf2", "second order, damps more", OptionsOf<BackwardDifferenceParameters>()),
       named_integrator<BackwardEuler>("backward-euler", "first order, damps most: the calmest",
                                       OptionsOf<BackwardDifferenceParameters>())});
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
