supple_test(subspace LABEL unit LINKS supple::reduction 
  SOURCES reduction/subspace/subspace_test.cpp reduction/subspace/own_structure_test.cpp)
supple_test(bases LABEL unit LINKS supple::reduction SOURCES reduction/basis/bases_test.cpp)
supple_test(modal_derivatives LABEL unit LINKS supple::reduction SOURCES reduction/basis/modal_derivatives_test.cpp)
supple_test(reduced_system LABEL unit LINKS supple::reduction SOURCES reduction/system/reduced_system_test.cpp)
supple_test(stiffness_range LABEL unit LINKS supple::reduction SOURCES reduction/system/stiffness_range_test.cpp)
supple_test(force_fitting LABEL unit LINKS supple::reduction SOURCES reduction/training/force_fitting_test.cpp)
supple_test(equilibrium_fitting LABEL unit LINKS supple::reduction
  SOURCES reduction/training/equilibrium_fitting_test.cpp)
supple_test(error_indicator LABEL unit LINKS supple::reduction SOURCES reduction/training/error_indicator_test.cpp)
supple_test(exact_equilibria LABEL unit LINKS supple::reduction SOURCES reduction/training/exact_equilibria_test.cpp)
supple_test(relaxation LABEL unit LINKS supple::reduction SOURCES reduction/training/relaxation_test.cpp)
supple_test(reduce LABEL unit LINKS supple::reduction SOURCES reduction/pipeline/reduce_test.cpp)
supple_test(sound_models LABEL unit LINKS supple::reduction
  SOURCES reduction/pipeline/degenerate_objects_test.cpp reduction/pipeline/sound_models_test.cpp
          reduction/subspace/rigid_motions_test.cpp)
supple_test(models LABEL unit LINKS supple::reduction
  SOURCES reduction/pipeline/model_choice_test.cpp reduction/pipeline/model_ladder_test.cpp
          reduction/pipeline/model_series_test.cpp)
supple_test(selection_study LABEL unit LINKS supple::reduction SOURCES reduction/pipeline/selection_study_test.cpp)
supple_test(heat_reduction LABEL unit LINKS supple::reduction SOURCES reduction/pipeline/heat_test.cpp)
supple_test(editor LABEL unit LINKS supple::reduction SOURCES reduction/editing/editor_test.cpp)

if(TARGET gent_plugin)  # an example
  foreach(plugin no_plugin other_version twice)
    supple_plugin(${plugin} plugins/${plugin}.cpp)
    target_include_directories(${plugin} PRIVATE ${PROJECT_SOURCE_DIR})
    supple_build_options(${plugin})
    set_target_properties(${plugin} PROPERTIES LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/plugins)
  endforeach()
  supple_test(plugin LABEL unit LINKS supple::reduction supple::testing
    SOURCES reduction/plugin/plugin_test.cpp)
  target_compile_definitions(test_plugin PRIVATE SUPPLE_PLUGINS="${PROJECT_BINARY_DIR}/plugins")
  add_dependencies(test_plugin no_plugin other_version twice gent_plugin spring_tets_plugin)
endif()
