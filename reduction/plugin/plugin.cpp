#include <core/check.hpp>
#include <reduction/plugin/plugin.hpp>

#include <cstdint>
#include <dlfcn.h>
#include <elf.h>
#include <fstream>
#include <set>

namespace supple {

namespace {

/// Entries for one registry, until all of a plug-in are known to be good.
template <typename Entry>
class Pending {
 public:
  explicit Pending(Registry<Entry>& all) : all_(all) {}

  void add(Entry entry) {
    for (const Entry& other : entries_) require(other.name != entry.name, "it adds '" + entry.name + "' twice");
    all_.require_new(entry.name);
    entries_.push_back(std::move(entry));
  }
  void commit() {
    for (Entry& entry : entries_) all_.add(std::move(entry));
  }

 private:
  Registry<Entry>& all_;
  std::vector<Entry> entries_;
};

/// Collects, so that a plug-in that fails half way leaves nothing.
class Collected final : public PluginRegistry {
 public:
  void add(MaterialLaw law) override {
    require(law.from && law.objection && law.tets,
            "the material law '" + law.name + "' lacks `from`, `objection` or `tets`");
    laws_.add(std::move(law));
  }
  void add(NamedSelector selector) override {
    require(static_cast<bool>(selector.make), "the selector '" + selector.name + "' lacks `make`");
    selectors_.add(std::move(selector));
  }
  void add(NamedSubspace subspace) override {
    require(static_cast<bool>(subspace.build), "the subspace '" + subspace.name + "' lacks `build`");
    subspaces_.add(std::move(subspace));
  }
  void add(NamedIntegrator integrator) override {
    require(integrator.reduced && integrator.full,
            "the integrator '" + integrator.name + "' lacks `reduced` or `full`");
    integrators_.add(std::move(integrator));
  }
  void add(NamedOutsideForce force) override {
    require(static_cast<bool>(force.make), "the outside force '" + force.name + "' lacks `make`");
    forces_.add(std::move(force));
  }

  void commit() {
    laws_.commit();
    selectors_.commit();
    subspaces_.commit();
    integrators_.commit();
    forces_.commit();
  }

 private:
  Pending<MaterialLaw> laws_{material_law_registry()};
  Pending<NamedSelector> selectors_{selectors()};
  Pending<NamedSubspace> subspaces_{subspaces()};
  Pending<NamedIntegrator> integrators_{integrators()};
  Pending<NamedOutsideForce> forces_{outside_forces()};
};

std::string last_error() {
  const char* text = dlerror();
  return text ? text : "unknown reason";
}

/// Whether a library ends before its own table of sections does, as a copy that was cut short: loading it would end the
/// program.
bool is_cut_short(const std::filesystem::path& file) {
  Elf64_Ehdr header{};
  std::ifstream(file, std::ios::binary).read(reinterpret_cast<char*>(&header), sizeof header);
  if (std::string_view(reinterpret_cast<const char*>(header.e_ident), SELFMAG) != ELFMAG ||
      header.e_ident[EI_CLASS] != ELFCLASS64)
    return false;  // for the loader to say
  const std::uintmax_t size = std::filesystem::file_size(file);
  const std::uintmax_t sections = std::uintmax_t{header.e_shnum} * header.e_shentsize;
  return size < sizeof header || header.e_shoff > size || sections > size - header.e_shoff;
}

}  // namespace

void load_plugin(const std::filesystem::path& path) {
  static std::set<std::filesystem::path> loaded;
  const auto fail = [&](const std::string& reason) { return InputError(path.string() + ": " + reason); };
  std::error_code none;
  const std::filesystem::path file = std::filesystem::canonical(path, none);
  if (none) throw fail("there is no such file, expected a shared library");
  if (loaded.contains(file)) return;

  if (is_cut_short(file)) throw fail("this library is cut short");
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
  } catch (...) {
    throw fail("SUPPLE_PLUGIN threw something that is no std::exception");
  }
  collected.commit();
  loaded.insert(file);
}

}  // namespace supple
