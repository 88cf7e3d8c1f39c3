#include <core/tensor_file.hpp>
#include <reduction/reduced_model.hpp>

#include <charconv>

namespace supple {

namespace {

constexpr const char* format_name = "supple reduced model";
constexpr const char* format_version = "1";

std::vector<std::int64_t> widen(const std::vector<Index>& values) {
  return {values.begin(), values.end()};
}

}  // namespace

void save_model(const std::filesystem::path& path, const ReducedModel& model) {
  TensorFileWriter file;
  const Solid& solid = model.solid;
  file.metadata = {{"format", format_name}, {"format_version", format_version}, {"material.law", solid.law}};
  for (const auto& [key, text] : model.provenance) file.metadata["provenance." + key] = text;
  for (const auto& [tag, name] : solid.mesh.region_names)
    file.metadata["region." + std::to_string(tag)] = name;

  file.add("mesh.nodes", solid.mesh.nodes);
  std::vector<std::array<std::int32_t, 4>> tets;
  tets.reserve(solid.mesh.tets.size());
  for (const Tet& tet : solid.mesh.tets)
    tets.push_back({static_cast<std::int32_t>(tet[0]), static_cast<std::int32_t>(tet[1]),
                    static_cast<std::int32_t>(tet[2]), static_cast<std::int32_t>(tet[3])});
  file.add("mesh.tets", tets);
  if (!solid.mesh.region.empty())
    file.add("mesh.region", std::vector<std::int32_t>(solid.mesh.region.begin(), solid.mesh.region.end()));
  file.add("material.parameters", solid.parameters);
  if (!solid.material_of_tet.empty()) file.add("material.of_tet", solid.material_of_tet);
  file.add("density", solid.density);
  file.add("fixed_nodes", widen(solid.fixed_nodes));
  file.add("damping", (Vector(2) << solid.damping.alpha, solid.damping.beta).finished());

  std::visit(
      [&](const auto& basis) {
        file.metadata["subspace.block"] = std::to_string(std::remove_cvref_t<decltype(*basis)>::block);
        file.metadata["subspace.rigid_modes"] = std::to_string(basis->report.rigid_modes);
        file.add("subspace.W", basis->W);
        file.add("subspace.omega", basis->report.omega);
        file.add("subspace.residuals", basis->report.residuals);
      },
      model.subspace);
  file.add("selection.indices", widen(model.indices));
  file.add("selection.weights", model.weights);
  file.add("rest_stiffness", model.rest_stiffness);
  file.write(path);
}

ReducedModel load_model(const std::filesystem::path& path) {
  const TensorFile file(path);
  const auto fail = [&](const std::string& why) { return InputError(path.string() + ": " + why); };
  const auto whole_number = [&](const std::string& key, const std::string& text) {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size()) throw fail(key + ": '" + text + "' is not a whole number");
    return value;
  };
  if (!file.metadata().contains("format") || file.metadata("format") != format_name)
    throw fail("this is not a reduced model of Supple");
  if (file.metadata("format_version") != format_version)
    throw fail("the model has version " + file.metadata("format_version") + ", expected " + format_version);

  ReducedModel model;
  Solid& solid = model.solid;
  const auto nodes = file.matrix("mesh.nodes", TensorFile::any, 3);
  solid.mesh.nodes = nodes;
  const Index n = nodes.rows();
  const auto tets = file.values<std::int32_t>("mesh.tets", {TensorFile::any, 4});
  solid.mesh.tets.resize(tets.size() / 4);
  for (std::size_t k = 0; k < tets.size(); ++k) {
    if (tets[k] < 0 || tets[k] >= n)
      throw fail("mesh.tets names node " + std::to_string(tets[k]) + ", expected 0 to " +
                 std::to_string(n - 1));
    solid.mesh.tets[k / 4][k % 4] = tets[k];
  }
  const Index m = solid.mesh.num_tets();
  if (m == 0) throw fail("the mesh has no tets");
  if (file.contains("mesh.region")) {
    const auto region = file.values<std::int32_t>("mesh.region", {m});
    solid.mesh.region.assign(region.begin(), region.end());
  }
  for (const auto& [key, text] : file.metadata()) {
    if (key.starts_with("region.")) solid.mesh.region_names[whole_number(key, key.substr(7))] = text;
    if (key.starts_with("provenance.")) model.provenance[key.substr(11)] = text;
  }
  solid.law = file.metadata("material.law");
  solid.parameters = file.matrix("material.parameters");
  if (file.contains("material.of_tet")) {
    const auto of_tet = file.values<std::int32_t>("material.of_tet", {m});
    solid.material_of_tet.assign(of_tet.begin(), of_tet.end());
  }
  solid.density = file.vector("density");
  for (const std::int64_t v : file.integers("fixed_nodes")) {
    if (v < 0 || v >= n)
      throw fail("fixed_nodes names node " + std::to_string(v) + ", expected 0 to " + std::to_string(n - 1));
    solid.fixed_nodes.push_back(v);
  }
  const auto damping = file.vector("damping", 2);
  solid.damping = {damping[0], damping[1]};

  const auto load_basis = [&]<int block>(std::integral_constant<int, block>) {
    auto basis = std::make_shared<KroneckerBasis<block>>();
    basis->W = file.matrix("subspace.W", 3 * n / block, TensorFile::any);
    basis->report.omega = file.vector("subspace.omega");
    basis->report.residuals = file.vector("subspace.residuals", basis->report.omega.size());
    basis->report.rigid_modes = whole_number("subspace.rigid_modes", file.metadata("subspace.rigid_modes"));
    if (basis->report.rigid_modes < 0 || basis->report.rigid_modes > basis->report.omega.size())
      throw fail("subspace.rigid_modes is " + std::to_string(basis->report.rigid_modes) + ", expected 0 to " +
                 std::to_string(basis->report.omega.size()));
    model.subspace = std::shared_ptr<const KroneckerBasis<block>>(std::move(basis));
  };
  const std::string& block = file.metadata("subspace.block");
  if (block == "3")
    load_basis(std::integral_constant<int, 3>{});
  else if (block == "1")
    load_basis(std::integral_constant<int, 1>{});
  else
    throw fail("subspace.block is '" + block + "', expected 1 or 3");

  for (const std::int64_t i : file.integers("selection.indices")) {
    if (i < 0 || i >= m)
      throw fail("selection.indices names tet " + std::to_string(i) + ", expected 0 to " +
                 std::to_string(m - 1));
    if (!model.indices.empty() && i <= model.indices.back())
      throw fail("selection.indices are not ascending: " + std::to_string(i) + " follows " +
                 std::to_string(model.indices.back()));
    model.indices.push_back(i);
  }
  model.weights = file.vector("selection.weights", static_cast<Index>(model.indices.size()));
  model.rest_stiffness = file.matrix("rest_stiffness", model.dim(), model.dim());
  if (!model.weights.allFinite() || !(model.weights.array() > 0).all())
    throw fail("selection.weights are not all positive");
  if (!(damping.array() >= 0).all()) throw fail("damping is negative or not a number, expected 0 or more");
  if (!nodes.allFinite() || !damping.allFinite() || !solid.parameters.allFinite() || !solid.density.allFinite() ||
      !std::visit([](const auto& basis) { return basis->report.omega.allFinite(); }, model.subspace) || !model.rest_stiffness.allFinite() ||
      !std::visit([](const auto& basis) { return basis->W.allFinite(); }, model.subspace))
    throw fail("it holds numbers that are not finite");
  try {  // what constructing the model demands: law, parameters, volumes
    with_law(solid.law, [&]<template <typename> class Material>() { (void)make_model<Material>(solid); });
    (void)solid.nodal_mass();
  } catch (const std::invalid_argument& error) {
    throw fail(error.what());
  }
  return model;
}

}  // namespace supple
