#pragma once
/// \file Plug-ins: materials, elements, selectors, subspaces, integrators and outside forces of one's own, from a shared
/// library, in programs that are built already.
///
///     #include <reduction/plugin/plugin.hpp>
///     SUPPLE_PLUGIN(registry) { registry.add(supple::make_material_law<MyMaterial>("my-material")); }
///
/// compiled against the installed package (CMake: `supple_plugin(my_material my_material.cpp)`) makes a library that
/// `supple reduce … --plugin libmy_material.so --material my-material` loads. Types of the C++ library and of Eigen
/// cross the edge, so library and program must agree in SUPPLE_PLUGIN_ABI: version of Supple, compiler, standard library
/// and alignment. Instruction sets may differ. A library is never unloaded.

#include <core/version.hpp>
#include <physics/body/material_law.hpp>
#include <physics/load/outside_force_library.hpp>
#include <physics/time/integrator_library.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <sparse/selectors/selector_library.hpp>

#include <filesystem>
#include <string>

namespace supple {

/// What a plug-in adds to. Each throws std::invalid_argument if there is one of this name.
class PluginRegistry {
 public:
  virtual ~PluginRegistry() = default;
  /// A law of solids; with a function `tets` of its own it may be any element of tets' nodes. Where it leaves
  /// `hexahedra` and `quadratic_tets` empty, meshes of these are refused.
  virtual void add(MaterialLaw law) = 0;
  virtual void add(NamedSelector selector) = 0;
  virtual void add(NamedSubspace subspace) = 0;
  virtual void add(NamedIntegrator integrator) = 0;
  virtual void add(NamedOutsideForce force) = 0;
};

/// Loads a plug-in and adds what it has, all or nothing; again does nothing.
/// \throws InputError naming the file: not a library, not a plug-in, or built for another SUPPLE_PLUGIN_ABI.
void load_plugin(const std::filesystem::path& path);

}  // namespace supple

#define SUPPLE_ABI_TEXT_(x) #x
#define SUPPLE_ABI_TEXT(x) SUPPLE_ABI_TEXT_(x)
#ifdef _GLIBCXX_USE_CXX11_ABI
#define SUPPLE_ABI_STRINGS ", C++11 strings " SUPPLE_ABI_TEXT(_GLIBCXX_USE_CXX11_ABI)
#else
#define SUPPLE_ABI_STRINGS ""
#endif
/// What a program and its plug-ins must have in common, as seen by the translation unit that asks.
#define SUPPLE_PLUGIN_ABI                                                                                           \
  "Supple " SUPPLE_VERSION ", compiler " SUPPLE_ABI_TEXT(__GNUC__) ", ABI " SUPPLE_ABI_TEXT(__GXX_ABI_VERSION)      \
      SUPPLE_ABI_STRINGS                                                                                            \
      ", Eigen " SUPPLE_ABI_TEXT(EIGEN_WORLD_VERSION) "." SUPPLE_ABI_TEXT(EIGEN_MAJOR_VERSION) "." SUPPLE_ABI_TEXT( \
          EIGEN_MINOR_VERSION) " aligned to " SUPPLE_ABI_TEXT(EIGEN_MAX_STATIC_ALIGN_BYTES)

/// Defines what the program looks for; followed by a body that adds to `registry`.
#define SUPPLE_PLUGIN(registry)                                                               \
  static void supple_plugin_add(supple::PluginRegistry& registry);                            \
  extern "C" [[gnu::visibility("default")]] const char* supple_plugin_abi() {                 \
    return SUPPLE_PLUGIN_ABI;                                                                 \
  }                                                                                           \
  extern "C" [[gnu::visibility("default")]] void supple_plugin(supple::PluginRegistry& all) { \
    supple_plugin_add(all);                                                                   \
  }                                                                                           \
  static void supple_plugin_add(supple::PluginRegistry& registry)
