// What a material costs: the reduced force and tangent of every law, by hand and derived from its energy, relative to St.
// Venant–Kirchhoff chosen when compiling. Medians of interleaved rounds, so that a busy machine is busy for all.
//
//   $ benchmark_materials
#include <core/median.hpp>
#include <core/stopwatch.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <io/mesh/node_sets.hpp>
#include <physics/body/solid_model.hpp>
#include <physics/model/tet_elasticity.hpp>
#include <reduction/model/with_reduced_system.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <algorithm>
#include <cstdio>
#include <functional>

#include "../examples/gent.hpp"

namespace own {  // named, so that the models of these laws may be

using namespace supple;

/// A law of which only the energy is known.
template <template <typename> class Law>
struct EnergyOf {
  template <typename Real>
  struct Material : private Law<Real> {
    static constexpr auto parameter_names = Law<Real>::parameter_names;
    static Material from(const IsotropicModuli& m) { return {Law<Real>::from(m)}; }
    Real energy(const Matrix3<Real>& F) const { return Law<Real>::energy(F); }
    explicit(false) Material(const Law<Real>& law) : Law<Real>(law) {}
    Material() = default;
  };
};
/// St. Venant–Kirchhoff as a user would write it.
template <typename Real>
struct OwnStVenantKirchhoff : StVenantKirchhoff<Real> {
  static OwnStVenantKirchhoff from(const IsotropicModuli& m) { return {StVenantKirchhoff<Real>::from(m)}; }
};

}  // namespace own

namespace {

using namespace supple;
using namespace own;

struct Entry {
  std::string name;
  std::function<void()> force, tangent;
  std::vector<double> force_seconds = {}, tangent_seconds = {};
};

double seconds_of(const std::function<void()>& work, int repetitions) {
  const Stopwatch watch;
  for (int k = 0; k < repetitions; ++k) work();
  return watch.seconds() / repetitions;
}

}  // namespace

int main() {
  const IsotropicModuli moduli{.young = 1e5, .poisson = 0.4};
  const TetMesh mesh = builtin_mesh("bar:18x6x6");
  const Solid solid = isotropic_solid(mesh, moduli, select_nodes(mesh.nodes, "x<1%"));
  const ReducedModel model = reduce(solid, {.points = 152, .held_out_poses = 0});
  const auto subspace = std::get<std::shared_ptr<const NodalBasis>>(model.subspace);
  const Vector q = 0.01 * Vector::LinSpaced(model.dim(), -1, 1);
  Vector f(model.dim());
  Matrix K;

  std::vector<Entry> entries;
  const auto add = [&]<typename Model>(std::string name, std::shared_ptr<const Model> force) {
    const auto system = std::make_shared<const ReducedSystem<Model, NodalBasis>>(
        force, subspace, model.indices, model.weights, model.rest_stiffness, nodal_mass(model.body));
    entries.push_back(
        {std::move(name), [system, &q, &f] { system->force(q, f); }, [system, &q, &K] { system->stiffness(q, K); }});
  };
  const auto add_law = [&](const std::string& name, const MaterialLaw& law) {
    const std::vector<double> values = law.from(moduli);
    add(name, law.tets(mesh, Eigen::Map<const RowMatrix>(values.data(), 1, static_cast<Index>(values.size())), {}));
  };
  add("stvk, chosen when compiling",
      std::make_shared<const TetElasticity<StVenantKirchhoff>>(make_model<StVenantKirchhoff>(solid)));
  for (const std::string& name : material_laws()) add_law(name, material_law(name));
  add_law("a user's, stress and tangent by hand (stvk)", make_material_law<OwnStVenantKirchhoff>("own"));
  add_law("stvk, energy alone", make_material_law<EnergyOf<StVenantKirchhoff>::Material>("energy"));
  add_law("mooney-rivlin, energy alone", make_material_law<EnergyOf<MooneyRivlin>::Material>("energy"));
  add_law("a user's, energy alone (Gent)", make_material_law<Gent>("gent"));

  for (int round = 0; round < 41; ++round)
    for (Entry& entry : entries) {
      entry.force_seconds.push_back(seconds_of(entry.force, 100));
      entry.tangent_seconds.push_back(seconds_of(entry.tangent, 5));
    }
  const double force = median(entries[0].force_seconds), tangent = median(entries[0].tangent_seconds);
  std::printf("| | force | tangent |\n| --- | ---: | ---: |\n");
  for (const Entry& entry : entries)
    std::printf("| %s | %.2f | %.2f |\n", entry.name.c_str(), median(entry.force_seconds) / force,
                median(entry.tangent_seconds) / tangent);
  std::printf("\n1.00 are %.1f and %.0f us; s = %td, d = %td\n", 1e6 * force, 1e6 * tangent,
              static_cast<std::ptrdiff_t>(model.indices.size()), model.dim());
}
