// Fails half way: what it added first must not stay.
#include <examples/gent.hpp>
#include <reduction/plugin/plugin.hpp>

SUPPLE_PLUGIN(registry) {
  registry.add(supple::make_material_law<Gent>("half-way"));
  registry.add(supple::make_material_law<Gent>("stvk"));
}
