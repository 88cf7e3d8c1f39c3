// An element of one's own for programs that are built already.
//   $ supple reduce bar --plugin ./libspring_tets_plugin.so --material spring-tets --fix 'x<1%' -o bar.supple
#include <reduction/plugin/plugin.hpp>

#include "spring_tets.hpp"

SUPPLE_PLUGIN(registry) {
  registry.add(spring_tets());
}
