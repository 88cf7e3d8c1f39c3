# supple_plugin(<name> <source>...): a shared library that programs of Supple load with --plugin, see reduction/plugin/plugin.hpp.
function(supple_plugin name)
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE supple::reduction)
  set_target_properties(${name} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
endfunction()
