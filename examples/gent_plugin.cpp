// The same material for programs that are built already:
//   $ supple reduce bar --plugin ./libgent_plugin.so --material gent --parameter limit=5 -o bar.supple
#include <reduction/plugin/plugin.hpp>

#include "gent.hpp"

SUPPLE_PLUGIN(registry) {
  registry.add(supple::make_material_law<Gent>("gent"));
}
