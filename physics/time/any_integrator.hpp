#pragma once
/// \file Integrator of second order, its type erased: a value.

#include <physics/time/time_integrator.hpp>

#include <functional>
#include <memory>

namespace supple {

/// A TimeIntegratorFor<System> whose state is a State, behind one type: what scenes choose by name. Moves, for it has the
/// memory of its solver.
template <DynamicalSystem System>
class AnyIntegrator {
 public:
  using MatrixType = typename System::MatrixType;
  using State = supple::State;

  template <TimeIntegratorFor<System> I>
  requires(std::same_as<typename I::State, State> &&
           !std::same_as<I, AnyIntegrator>) explicit AnyIntegrator(std::unique_ptr<I> integrator)
      : integrator_(std::make_unique<Of<I>>(std::move(integrator))) {}

  double step_size() const { return integrator_->step_size(); }  ///< [s]
  int order() const { return integrator_->order(); }
  EnergyBehaviour energy_behaviour() const { return integrator_->energy_behaviour(); }
  State at_rest() const { return integrator_->at_rest(); }
  /// The acceleration that u and v imply under this load.
  void balance(const SystemLoad<MatrixType>& load, State& state) const { integrator_->balance(load, state); }
  template <LoadOverTime<MatrixType> Load = SystemLoad<MatrixType>>
  StepReport step(const Load& load, State& state) {
    SystemLoad<MatrixType> now;  // keeps what a function of time returns by value
    return integrator_->step(
        [&](double t) -> const SystemLoad<MatrixType>& {
          if constexpr (std::invocable<const Load&, double>) {
            if constexpr (std::is_reference_v<decltype(load(t))>)
              return load(t);
            else
              return now = load(t);
          } else {
            return load;
          }
        },
        state);
  }

 private:
  using LoadAt = std::function<const SystemLoad<MatrixType>&(double)>;
  class Interface {
   public:
    virtual ~Interface() = default;
    virtual double step_size() const = 0;
    virtual int order() const = 0;
    virtual EnergyBehaviour energy_behaviour() const = 0;
    virtual State at_rest() const = 0;
    virtual void balance(const SystemLoad<MatrixType>& load, State& state) const = 0;
    virtual StepReport step(const LoadAt& load, State& state) = 0;
  };
  template <typename I>
  class Of final : public Interface {
   public:
    explicit Of(std::unique_ptr<I> integrator) : own_(std::move(integrator)) {}
    double step_size() const override { return own_->step_size(); }
    int order() const override { return own_->order(); }
    EnergyBehaviour energy_behaviour() const override { return own_->energy_behaviour(); }
    State at_rest() const override { return own_->at_rest(); }
    void balance(const SystemLoad<MatrixType>& load, State& state) const override { own_->balance(load, state); }
    StepReport step(const LoadAt& load, State& state) override { return own_->step(load, state); }

   private:
    std::unique_ptr<I> own_;
  };

  std::unique_ptr<Interface> integrator_;
};

}  // namespace supple
