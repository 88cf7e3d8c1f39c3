#include <app/scene/integrate.hpp>

namespace supple {

Simulation simulate_reduced(const ReducedModel& model, const Scene& scene, const SimulationOptions& options,
                            const Progress& progress) {
  const Stopwatch watch;
  return with_reduced_system(
      model,
      [&](const auto& system) {
        const double construction = watch.seconds();
        Simulation result = integrate(
            system, scene, options, [](VectorIn q) -> Vector { return q; },
            [&](VectorIn q, Index node) -> Point {
              const auto& subspace = system.subspace();
              return {subspace.at(3 * node, q), subspace.at(3 * node + 1, q), subspace.at(3 * node + 2, q)};
            },
            progress);
        result.setup_seconds += construction;
        return result;
      },
      options.precision);
}

}  // namespace supple
