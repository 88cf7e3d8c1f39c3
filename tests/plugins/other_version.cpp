#include <examples/gent.hpp>
#include <reduction/plugin/plugin.hpp>

#undef SUPPLE_VERSION
#define SUPPLE_VERSION "0.0.9"
SUPPLE_PLUGIN(registry) {
  registry.add(supple::make_material_law<Gent>("too-old"));
}
