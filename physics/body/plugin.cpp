#include <core/check.hpp>
#include <physics/body/plugin.hpp>

#include <algorithm>
#include <dlfcn.h>
#include <set>

namespace supple {

namespace {

/// Collects, so that a plug-in that fails half way leaves nothing.
class Collected final : public PluginRegistry {
 public:
  void add(MaterialLaw law) override {
    for (const MaterialLaw& other : laws) require(other.name != law.name, "it adds '" + law.name + "' twice");
    const std::vector<std::string> known = material_laws();
    require(std::ranges::count(known, law.name) == 0, "there is a material law '" + law.name + "' already");
    require(law.from && law.objection && law.tets,
            "the material law '" + law.name + "' lacks `from`, `objection` or `tets`");
    laws.push_back(std::move(law));
  }
  std::vector<MaterialLaw> laws;
};

std::string last_error() {
  const char* text = dlerror();
  return text ? text : "unknown reason";
}

}  // namespace

void load_plugin(const std::filesystem::path& path) {
  static std::set<std::filesystem::path> loaded;
  const auto fail = [&](const std::string& reason) { return InputError(path.string() + ": " + reason); };
  std::error_code none;
  const std::filesystem::path file = std::filesystem::canonical(path, none);
  if (none) throw fail("there is no such file, expected a shared library");
  if (loaded.contains(file)) return;

  void* const library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw fail("this is not a shared library that can be loaded: " + last_error());
  const auto abi = reinterpret_cast<const char* (*)()>(dlsym(library, "supple_plugin_abi"));
  const auto plugin = reinterpret_cast<void (*)(PluginRegistry&)>(dlsym(library, "supple_plugin"));
  if (!abi || !plugin) throw fail("this is not a plug-in of Supple: it has no SUPPLE_PLUGIN");
  if (const std::string own = SUPPLE_PLUGIN_ABI; abi() != own)
    throw fail("this plug-in was built for " + std::string(abi()) + ", expected " + own + "; build it again");
  Collected collected;
  try {
    plugin(collected);
  } catch (const std::exception& error) {
    throw fail(error.what());
  }
  for (MaterialLaw& law : collected.laws) add_material_law(std::move(law));
  loaded.insert(file);
}

}  // namespace supple
