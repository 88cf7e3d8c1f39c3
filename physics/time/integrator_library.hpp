#pragma once
/// \file Registry of time integrators, for scenes.

#include <core/registry.hpp>
#include <physics/system/any_system.hpp>
#include <physics/time/any_integrator.hpp>
#include <physics/time/implicit_step.hpp>
#include <physics/time/step_control.hpp>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace supple {

/// A time integrator by name, for reduced (dense) and full (sparse) systems alike.
struct NamedIntegrator {
  template <typename MatrixType>
  using Make = std::function<AnyIntegrator<AnySystem<MatrixType>>(
      const AnySystem<MatrixType>& system, double h, const StepOptions& step, const OptionValues& options)>;

  std::string name, description;
  std::vector<OptionInfo> options;
  /// \throws std::invalid_argument for options that it has not, or that make no sense. The system must outlive what they
  /// make.
  Make<Matrix> reduced;
  Make<SparseMatrix> full;
};

/// The entry of an integrator of one's own: a class template over the system, constructed as
/// Integrator<System>(system, h, StepOptions, Parameters).
///
///     integrators().add(named_integrator<MyMethod>("my-method", "what it is good for",
///                                                  OptionsOf<MyParameters>().add("theta", &MyParameters::theta, "…")));
template <template <DynamicalSystem> class Integrator, typename Parameters>
NamedIntegrator named_integrator(std::string name, std::string description, OptionsOf<Parameters> options) {
  for (const OptionInfo& option : options.info())
    require(option.name != "method",
            "integrator " + name + " has an option 'method', which scenes name integrators by");
  const auto make = [name, options]<typename System>(const System& system, double h, const StepOptions& step,
                                                     const OptionValues& values) {
    const Parameters parameters = options.make(values, "integrator " + name);
    return AnyIntegrator<System>(std::make_unique<Integrator<System>>(system, h, step, parameters));
  };
  return {name, std::move(description), options.info(), make, make};
}

/// All integrators by name, the default first: "average-vector-field", "newmark", "generalized-alpha", "tr-bdf2", "bdf2",
/// "backward-euler" and what was added.
Registry<NamedIntegrator>& integrators();

/// An integrator as a user chooses it, "generalized-alpha:rho_infinity=0.9", of steps of h [s].
/// \param system  must outlive the integrator.
AnyIntegrator<AnySystem<Matrix>> make_integrator(const Choice& choice, const AnySystem<Matrix>& system, double h,
                                                 const StepOptions& step);
AnyIntegrator<AnySystem<SparseMatrix>> make_integrator(const Choice& choice, const AnySystem<SparseMatrix>& system,
                                                       double h, const StepOptions& step);
AnyIntegrator<AnySystem<Matrix>> make_integrator(const Choice&, const AnySystem<Matrix>&&, double,
                                                 const StepOptions&) = delete;  // it would dangle
AnyIntegrator<AnySystem<SparseMatrix>> make_integrator(const Choice&, const AnySystem<SparseMatrix>&&, double,
                                                       const StepOptions&) = delete;

/// The same under control of its steps; those that fail however short they are go to backward Euler.
template <typename MatrixType>
ControlledIntegrator<AnySystem<MatrixType>> make_controlled_integrator(const Choice& choice,
                                                                       const AnySystem<MatrixType>& system, double h,
                                                                       const StepOptions& step,
                                                                       const StepControl& control) {
  const auto by = [&system, &step](Choice method) {
    return [&system, step, method = std::move(method)](double part) {
      return make_integrator(method, system, part, step);
    };
  };
  return {system, h, by(choice), step.damping, control, by({"backward-euler"})};
}

/// What a choice promises about energy.
/// \throws std::invalid_argument for one that no system could be integrated by: unknown, or with options out of range.
EnergyBehaviour energy_behaviour(const Choice& choice);

}  // namespace supple
