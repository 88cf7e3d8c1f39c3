#include <app/scene/integrate.hpp>
#include <physics/body/force_models.hpp>
#include <physics/system/full_system.hpp>

namespace supple {

Simulation simulate_full(const Body& body, const Scene& scene, const SimulationOptions& options,
                         const Progress& progress) {
  return with_force_model(body, [&]<typename Model>(const std::shared_ptr<const Model>& model) {
    const Stopwatch watch;
    tell(progress, "full system", 0);
    const FullSystem<Model> system(model, nodal_mass(body), fixed_nodes(body));
    const double construction = watch.seconds();
    Simulation result = integrate(
        system, scene, options, [&](VectorIn u) { return system.expand(u); },
        [&](VectorIn u, Index node) -> Point {
          const Index f = system.numbering().free_index(node);
          return f < 0 ? Point(Point::Zero()) : Point(u.segment<3>(3 * f));
        },
        progress);
    result.setup_seconds += construction;
    return result;
  });
}

}  // namespace supple
