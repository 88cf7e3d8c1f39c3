supple_test(reduction LABEL unit LINKS supple::reduction
  SOURCES reduction/basis/bases_test.cpp reduction/basis/modal_derivatives_test.cpp reduction/editing/editor_test.cpp
          reduction/pipeline/degenerate_objects_test.cpp reduction/pipeline/heat_test.cpp
          reduction/pipeline/model_choice_test.cpp reduction/pipeline/model_ladder_test.cpp
          reduction/pipeline/model_series_test.cpp reduction/pipeline/reduce_test.cpp
          reduction/pipeline/selection_study_test.cpp reduction/pipeline/sound_models_test.cpp
          reduction/subspace/own_structure_test.cpp reduction/subspace/rigid_motions_test.cpp
          reduction/subspace/sliding_supports_test.cpp
          reduction/subspace/subspace_test.cpp reduction/system/reduced_system_test.cpp
          reduction/system/stiffness_range_test.cpp reduction/training/equilibrium_fitting_test.cpp
          reduction/training/error_indicator_test.cpp reduction/training/exact_equilibria_test.cpp
          reduction/training/force_fitting_test.cpp reduction/training/relaxation_test.cpp)

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
