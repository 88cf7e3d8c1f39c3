#include <core/random.hpp>
#include <core/tensor_file.hpp>
#include <physics/body/force_models.hpp>
#include <reduction/model/reduced_model.hpp>

#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <functional>
#include <span>
#include <sstream>

namespace supple {

namespace {

constexpr const char* format_name = "supple reduced model";
constexpr const char *format_version = "1", *format_with_sliding_nodes = "2";

std::vector<std::int64_t> widen(const std::vector<Index>& values) {
  return {values.begin(), values.end()};
}

template <std::size_t corners>
std::vector<std::array<std::int32_t, corners>> narrow(const std::vector<std::array<Index, corners>>& elements) {
  std::vector<std::array<std::int32_t, corners>> result(elements.size());
  for (std::size_t e = 0; e < elements.size(); ++e)
    std::transform(elements[e].begin(), elements[e].end(), result[e].begin(),
                   [](Index v) { return static_cast<std::int32_t>(v); });
  return result;
}

/// What the arrays over the cells of a solid are called.
template <typename Mesh>
struct CellArrays {
  const char *cells, *material = "material.of_cell";
};
template <typename Mesh>
constexpr CellArrays<Mesh> arrays = {};
template <>
constexpr CellArrays<TetMesh> arrays<TetMesh> = {"mesh.tets", "material.of_tet"};
template <>
constexpr CellArrays<HexMesh> arrays<HexMesh> = {"mesh.hexahedra"};
template <>
constexpr CellArrays<QuadraticTetMesh> arrays<QuadraticTetMesh> = {"mesh.quadratic_tets"};

constexpr const char *component_key = "component", *gauss_point = "gauss-point";

template <typename Mesh>
void add_body(TensorFileWriter& file, const SolidOf<Mesh>& solid) {
  for (const auto& [tag, name] : solid.mesh.region_names) file.metadata["region." + std::to_string(tag)] = name;
  for (const auto& [tag, groups] : solid.mesh.region_groups) {
    std::string& list = file.metadata["region_groups." + std::to_string(tag)];
    for (const int group : groups) list += (list.empty() ? "" : " ") + std::to_string(group);
  }
  if (!std::same_as<Mesh, TetMesh> && solid.component == SolidComponent::GaussPoint)
    file.metadata[component_key] = gauss_point;
  file.add(arrays<Mesh>.cells, narrow(solid.mesh.cells));
  if (!solid.mesh.node_groups.empty()) {
    std::vector<std::int64_t> nodes, ends, faces, face_ends;
    for (const auto& [name, group] : solid.mesh.node_groups) {
      file.metadata["node_group." + std::to_string(ends.size())] = name;
      nodes.insert(nodes.end(), group.nodes.begin(), group.nodes.end());
      ends.push_back(static_cast<std::int64_t>(nodes.size()));
      for (const FaceCorners& face : group.faces) faces.insert(faces.end(), face.begin(), face.end());
      face_ends.push_back(static_cast<std::int64_t>(faces.size() / 4));
    }
    file.add("mesh.node_groups", nodes);
    file.add("mesh.node_group_ends", ends);
    file.add("mesh.face_groups", faces);
    file.add("mesh.face_group_ends", face_ends);
  }
  if (!solid.mesh.region.empty())
    file.add("mesh.region", std::vector<std::int32_t>(solid.mesh.region.begin(), solid.mesh.region.end()));
  file.add("material.parameters", solid.parameters);
  if (!solid.material_of_cell.empty()) file.add(arrays<Mesh>.material, solid.material_of_cell);
  file.add("density", solid.density);
}

void add_body(TensorFileWriter& file, const Shell& shell) {
  file.add("mesh.triangles", narrow(shell.mesh.triangles));
  RowMatrix parameters(static_cast<Index>(shell.materials.size()), 3);
  for (Index k = 0; k < parameters.rows(); ++k) {
    const ShellMaterial& material = shell.materials[k];
    parameters.row(k) << material.bending, material.stretch, material.area;
  }
  file.add("material.parameters", parameters);
  file.add("thickness", shell.thickness);
  file.add("density", shell.density);
}

/// Reads arrays of a model and says which one is wrong.
class ModelReader {
 public:
  explicit ModelReader(const std::filesystem::path& path) : path_(path), file(path) {}

  InputError fail(const std::string& why) const { return InputError(path_.string() + ": " + why); }

  int whole_number(const std::string& key, const std::string& text) const {
    int value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      throw fail(key + ": '" + text + "' is not a whole number");
    return value;
  }

  template <std::size_t corners>
  std::vector<std::array<Index, corners>> elements(const std::string& name, Index num_nodes) const {
    const auto nodes = file.values<std::int32_t>(name, {TensorFile::any, corners});
    if (nodes.empty()) throw fail(name + " is empty");
    std::vector<std::array<Index, corners>> result(nodes.size() / corners);
    for (std::size_t k = 0; k < nodes.size(); ++k) {
      if (nodes[k] < 0 || nodes[k] >= num_nodes)
        throw fail(name + " names node " + std::to_string(nodes[k]) + ", expected 0 to " +
                   std::to_string(num_nodes - 1));
      result[k / corners][k % corners] = nodes[k];
    }
    return result;
  }

  RowMatrix finite_matrix(const std::string& name, Index rows = TensorFile::any, Index cols = TensorFile::any) const {
    RowMatrix values = file.matrix(name, rows, cols);
    if (!values.allFinite()) throw fail(name + " holds a number that is not finite");
    return values;
  }
  Vector finite_vector(const std::string& name, Index size = TensorFile::any) const {
    Vector values = file.vector(name, size);
    if (!values.allFinite()) throw fail(name + " holds a number that is not finite");
    return values;
  }

  /// Component numbers below m, ascending, at least one.
  std::vector<Index> components(const std::string& name, Index m) const {
    std::vector<Index> result;
    for (const std::int64_t i : file.integers(name)) {
      if (i < 0 || i >= m)
        throw fail(name + " names component " + std::to_string(i) + ", expected 0 to " + std::to_string(m - 1));
      if (!result.empty() && i <= result.back())
        throw fail(name + " are not ascending: " + std::to_string(i) + " follows " + std::to_string(result.back()));
      result.push_back(i);
    }
    if (result.empty()) throw fail(name + " is empty, expected one component at least");
    return result;
  }
  /// One for each component, > 0.
  Vector positive_weights(const std::string& name, const std::vector<Index>& components) const {
    Vector weights = finite_vector(name, static_cast<Index>(components.size()));
    if (!(weights.array() > 0).all()) throw fail(name + " are not all positive");
    return weights;
  }

 private:
  std::filesystem::path path_;

 public:
  const TensorFile file;
};

/// Parts of a list that end at these places: calls take(k, begin, end) for each.
template <typename Take>
void visit_parts(const ModelReader& in, const std::string& name, std::size_t size, const Take& take) {
  std::size_t begin = 0, k = 0;
  for (const std::int64_t end : in.file.integers(name)) {
    if (end < static_cast<std::int64_t>(begin) || end > static_cast<std::int64_t>(size))
      throw in.fail(name + " are not ascending numbers up to " + std::to_string(size));
    take(k++, begin, static_cast<std::size_t>(end));
    begin = static_cast<std::size_t>(end);
  }
}

NodeGroups read_node_groups(const ModelReader& in, Index num_nodes) {
  NodeGroups groups;
  if (!in.file.contains("mesh.node_groups")) return groups;
  const auto name = [&](std::size_t k) { return in.file.metadata("node_group." + std::to_string(k)); };
  const auto nodes = in.file.integers("mesh.node_groups"), faces = in.file.integers("mesh.face_groups");
  visit_parts(in, "mesh.node_group_ends", nodes.size(), [&](std::size_t k, std::size_t begin, std::size_t end) {
    std::vector<Index>& group = groups[name(k)].nodes;
    for (std::size_t j = begin; j < end; ++j) {
      if (nodes[j] < 0 || nodes[j] >= num_nodes || (!group.empty() && nodes[j] <= group.back()))
        throw in.fail("mesh.node_groups has " + std::to_string(nodes[j]) +
                      ", expected ascending nodes of each group from 0 to " + std::to_string(num_nodes - 1));
      group.push_back(nodes[j]);
    }
  });
  visit_parts(in, "mesh.face_group_ends", faces.size() / 4, [&](std::size_t k, std::size_t begin, std::size_t end) {
    std::vector<FaceCorners>& group = groups[name(k)].faces;
    for (std::size_t j = begin; j < end; ++j) {
      const FaceCorners face{faces[4 * j], faces[4 * j + 1], faces[4 * j + 2], faces[4 * j + 3]};
      const std::span corners(face.begin(), face[3] < 0 ? 3u : 4u);
      if (corners.front() < 0 || corners.back() >= num_nodes || face[3] < -1 ||
          !std::ranges::is_sorted(corners, std::less_equal()) || (!group.empty() && !(group.back() < face)))
        throw in.fail("mesh.face_groups has a face whose corners are no ascending nodes, or faces that do not ascend");
      group.push_back(face);
    }
  });
  return groups;
}

template <typename Mesh>
SolidOf<Mesh> read_solid(const ModelReader& in, Points nodes) {
  SolidOf<Mesh> solid;
  solid.mesh.nodes = std::move(nodes);
  solid.mesh.cells = in.elements<Mesh::nodes_per_cell>(arrays<Mesh>.cells, solid.mesh.num_nodes());
  const Index m = solid.mesh.num_cells();
  solid.mesh.node_groups = read_node_groups(in, solid.mesh.num_nodes());
  if (in.file.metadata().contains(component_key)) {
    const std::string& component = in.file.metadata(component_key);
    if (std::same_as<Mesh, TetMesh> || component != gauss_point)
      throw in.fail("component is '" + component + "', expected " +
                    (std::same_as<Mesh, TetMesh> ? "none for tets" : std::string(gauss_point) + ", or none for cells"));
    solid.component = SolidComponent::GaussPoint;
  }
  if (in.file.contains("mesh.region")) {
    const auto region = in.file.values<std::int32_t>("mesh.region", {m});
    solid.mesh.region.assign(region.begin(), region.end());
  }
  for (const auto& [key, text] : in.file.metadata())
    if (key.starts_with("region.")) solid.mesh.region_names[in.whole_number(key, key.substr(7))] = text;
  constexpr std::string_view groups = "region_groups.";
  for (const auto& [key, text] : in.file.metadata())
    if (key.starts_with(groups)) {
      std::vector<int>& list = solid.mesh.region_groups[in.whole_number(key, key.substr(groups.size()))];
      std::istringstream words(text);
      for (std::string word; words >> word;) list.push_back(in.whole_number(key, word));
    }
  solid.law = in.file.metadata("material.law");
  solid.parameters = in.finite_matrix("material.parameters");
  if (in.file.contains(arrays<Mesh>.material)) {
    const auto of_cell = in.file.values<std::int32_t>(arrays<Mesh>.material, {m});
    solid.material_of_cell.assign(of_cell.begin(), of_cell.end());
  }
  solid.density = in.finite_vector("density");
  return solid;
}

NodePlaces read_places(const ModelReader& in, Index num_nodes) {
  constexpr const char *name = "mesh.node_places", *count = "mesh.nodes_of_file";
  NodePlaces places;
  if (!in.file.contains(name)) return places;
  places.count = in.whole_number(count, in.file.metadata(count));
  const std::span<const std::int64_t> list = in.file.integers(name);
  places.of_node.assign(list.begin(), list.end());
  if (static_cast<Index>(list.size()) != num_nodes || !std::ranges::is_sorted(list, std::less_equal()) ||
      (!list.empty() && (list.front() < 0 || list.back() >= places.count)))
    throw in.fail(std::string(name) + " are not " + std::to_string(num_nodes) + " ascending numbers from 0 to " +
                  std::to_string(places.count - 1));
  return places;
}

Shell read_shell(const ModelReader& in, Points nodes) {
  Shell shell;
  shell.mesh.nodes = std::move(nodes);
  shell.mesh.triangles = in.elements<3>("mesh.triangles", shell.mesh.num_nodes());
  const RowMatrix parameters = in.finite_matrix("material.parameters", TensorFile::any, 3);
  for (Index k = 0; k < parameters.rows(); ++k)
    shell.materials.push_back({parameters(k, 0), parameters(k, 1), parameters(k, 2)});
  shell.thickness = in.finite_vector("thickness");
  shell.density = in.finite_vector("density");
  return shell;
}

/// The object of whatever cells the file has.
Body read_body(const ModelReader& in, Points nodes) {
  constexpr std::array cells{arrays<TetMesh>.cells, arrays<HexMesh>.cells, arrays<QuadraticTetMesh>.cells,
                             "mesh.triangles"};
  std::vector<const char*> present;
  for (const char* name : cells)
    if (in.file.contains(name)) present.push_back(name);
  if (present.size() > 1) throw in.fail("there are both " + std::string(present[0]) + " and " + present[1]);
  if (present.empty()) {
    std::string names;
    for (const char* name : cells) names += (names.empty() ? "" : ", ") + std::string(name);
    throw in.fail("there are no cells, expected one of " + names);
  }
  if (present[0] == cells[1]) return read_solid<HexMesh>(in, std::move(nodes));
  if (present[0] == cells[2]) return read_solid<QuadraticTetMesh>(in, std::move(nodes));
  if (present[0] == cells[3]) return read_shell(in, std::move(nodes));
  return read_solid<TetMesh>(in, std::move(nodes));
}

/// Supports of nodes that slide; none in files without them.
std::vector<HeldAxes> read_held_axes(const ModelReader& in, Index n, const std::vector<Index>& fixed_nodes) {
  std::vector<HeldAxes> held;
  if (!in.file.contains("held_axes.nodes")) return held;
  const auto nodes = in.file.integers("held_axes.nodes"), axes = in.file.integers("held_axes.axes");
  if (nodes.size() != axes.size())
    throw in.fail("held_axes.axes has " + std::to_string(axes.size()) + " entries, expected " +
                  std::to_string(nodes.size()));
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    if (nodes[k] < 0 || nodes[k] >= n || std::ranges::binary_search(fixed_nodes, Index(nodes[k])))
      throw in.fail("held_axes.nodes names node " + std::to_string(nodes[k]) + ", expected 0 to " +
                    std::to_string(n - 1) + " and none that is fixed");
    if (!held.empty() && nodes[k] <= held.back().node) throw in.fail("held_axes.nodes are not ascending");
    if (axes[k] < 1 || axes[k] >= HeldAxes::all)
      throw in.fail("held_axes.axes has " + std::to_string(axes[k]) + ", expected 1 to 6");
    held.push_back({Index(nodes[k]), static_cast<std::uint8_t>(axes[k])});
  }
  return held;
}

/// \throws InputError unless the basis has columns, UᵀMU = I, and leaves fixed nodes where they are.
void check_basis(const ModelReader& in, const ReducedModel& model) {
  const Vector mass = nodal_mass(model.body);
  std::visit(
      [&](const auto& basis) {
        const RowMatrix& W = basis->W;
        const Index rows_of_node = W.rows() / mass.size();
        if (W.cols() == 0) throw in.fail("subspace.W has no columns");
        for (const Index v : fixed_nodes(model.body))
          if (!W.middleRows(v * rows_of_node, rows_of_node).isZero(0))
            throw in.fail("subspace.W moves node " + std::to_string(v) + ", which is fixed");
        for (const auto& [v, axes] : held_axes(model.body))
          for (Index c = 0; c < 3; ++c)
            if ((axes >> c & 1) && (rows_of_node != 3 || !W.row(3 * v + c).isZero(0)))
              throw in.fail("subspace.W moves node " + std::to_string(v) + " along " + "xyz"[c] + ", where it is held");
        const Vector masses = mass.replicate(1, rows_of_node).transpose().reshaped();
        Random random(1);
        const Matrix X = Matrix::NullaryExpr(W.cols(), 4, [&] { return random.normal(); });
        const Matrix Y = W.transpose() * (masses.asDiagonal() * (W * X)).eval();
        if (!((Y - X).norm() <= 1e-6 * X.norm()))
          throw in.fail("subspace.W is not orthonormal with the masses of the nodes");
      },
      model.subspace);
}

/// \param model  the rest of it.
ErrorIndicator read_indicator(const ModelReader& in, const ReducedModel& model) {
  const auto [m, rows] = with_force_model(model.body, []<typename Model>(const std::shared_ptr<const Model>& force) {
    return std::pair<Index, Index>(force->num_components(), num_active_dofs<Model>);
  });
  ErrorIndicator indicator;
  indicator.indices = in.components("indicator.indices", m);
  for (const Index i : indicator.indices)
    if (std::binary_search(model.indices.begin(), model.indices.end(), i))
      throw in.fail("indicator.indices names component " + std::to_string(i) + ", which selection.indices has");
  indicator.weights = in.positive_weights("indicator.weights", indicator.indices);
  indicator.outside_stiffness = in.finite_vector("indicator.outside_stiffness");
  if (!(indicator.outside_stiffness.array() > 0).all())
    throw in.fail("indicator.outside_stiffness is not all positive");
  indicator.rows =
      in.finite_matrix("indicator.rows", indicator.weights.size() * rows, model.dim() + indicator.num_outside());
  const Vector calibration = in.finite_vector("indicator.calibration", 2);
  if (!(calibration.array() > 0).all()) throw in.fail("indicator.calibration is not all positive");
  indicator.scale = calibration[0];
  indicator.trained_size = calibration[1];
  return indicator;
}

}  // namespace

void save_model(const std::filesystem::path& path, const ReducedModel& model) {
  TensorFileWriter file;
  file.metadata = {{"format", format_name},
                   {"format_version", held_axes(model.body).empty() ? format_version : format_with_sliding_nodes},
                   {"material.law", std::string(law(model.body))},
                   {"subspace.name", model.subspace_name}};
  for (const auto& [key, text] : model.provenance) file.metadata["provenance." + key] = text;
  file.add("mesh.nodes", node_positions(model.body));
  if (const NodePlaces& places = node_places(model.body); !places.of_node.empty()) {
    file.add("mesh.node_places", widen(places.of_node));
    file.metadata["mesh.nodes_of_file"] = std::to_string(places.count);
  }
  std::visit([&](const auto& body) { add_body(file, body); }, model.body);
  file.add("fixed_nodes", widen(fixed_nodes(model.body)));
  if (const std::vector<HeldAxes>& held = held_axes(model.body); !held.empty()) {
    std::vector<Index> nodes, axes;
    for (const HeldAxes& one : held) {
      nodes.push_back(one.node);
      axes.push_back(one.axes);
    }
    file.add("held_axes.nodes", widen(nodes));
    file.add("held_axes.axes", widen(axes));
  }
  file.add("damping", (Vector(2) << damping(model.body).alpha, damping(model.body).beta).finished());

  std::visit(
      [&](const auto& basis) {
        file.metadata["subspace.block"] = std::to_string(std::remove_cvref_t<decltype(*basis)>::block);
        file.metadata["subspace.rigid_modes"] = std::to_string(basis->report.rigid_modes);
        file.metadata["subspace.zero_modes"] = std::to_string(basis->report.zero_modes);
        file.add("subspace.W", basis->W);
        file.add("subspace.omega", basis->report.omega);
        file.add("subspace.residuals", basis->report.residuals);
      },
      model.subspace);
  file.add("selection.indices", widen(model.indices));
  file.add("selection.weights", model.weights);
  file.add("rest_stiffness", model.rest_stiffness);
  if (model.indicator) {
    const ErrorIndicator& indicator = *model.indicator;
    file.add("indicator.indices", widen(indicator.indices));
    file.add("indicator.weights", indicator.weights);
    file.add("indicator.rows", indicator.rows);
    file.add("indicator.outside_stiffness", indicator.outside_stiffness);
    file.add("indicator.calibration", (Vector(2) << indicator.scale, indicator.trained_size).finished());
  }
  file.write(path);
}

ReducedModel load_model(const std::filesystem::path& path) {
  const ModelReader in(path);
  const TensorFile& file = in.file;
  if (!file.metadata().contains("format") || file.metadata("format") != format_name)
    throw in.fail("this is not a reduced model of Supple");
  if (const std::string& version = file.metadata("format_version");
      version != format_version && version != format_with_sliding_nodes)
    throw in.fail("the model has version " + version + ", expected " + format_version + " or " +
                  format_with_sliding_nodes);

  ReducedModel model;
  const Points nodes = in.finite_matrix("mesh.nodes", TensorFile::any, 3);
  const Index n = nodes.rows();
  model.body = read_body(in, nodes);
  for (const auto& [key, text] : file.metadata())
    if (key.starts_with("provenance.")) model.provenance[key.substr(11)] = text;
  std::visit(
      [&](auto& body) {
        body.mesh.places = read_places(in, n);
        for (const std::int64_t v : file.integers("fixed_nodes")) {
          if (v < 0 || v >= n)
            throw in.fail("fixed_nodes names node " + std::to_string(v) + ", expected 0 to " + std::to_string(n - 1));
          if (!body.fixed_nodes.empty() && v <= body.fixed_nodes.back())
            throw in.fail("fixed_nodes are not ascending: " + std::to_string(v) + " follows " +
                          std::to_string(body.fixed_nodes.back()));
          body.fixed_nodes.push_back(v);
        }
        body.held_axes = read_held_axes(in, n, body.fixed_nodes);
        const Vector damping = in.finite_vector("damping", 2);
        if ((damping.array() < 0).any()) throw in.fail("damping is negative, expected 0 or more");
        body.damping = {damping[0], damping[1]};
      },
      model.body);

  const auto load_basis = [&]<int block>(std::integral_constant<int, block>) {
    auto basis = std::make_shared<KroneckerBasis<block>>();
    basis->W = in.finite_matrix("subspace.W", 3 * n / block);
    SubspaceReport& report = basis->report;
    report.omega = in.finite_vector("subspace.omega");
    report.residuals = file.vector("subspace.residuals", report.omega.size());
    const auto number_of_modes = [&](const std::string& key, Index least) {
      const Index count = in.whole_number(key, file.metadata(key));
      if (count < least || count > report.omega.size())
        throw in.fail(key + " is " + std::to_string(count) + ", expected " + std::to_string(least) + " to " +
                      std::to_string(report.omega.size()));
      return count;
    };
    report.rigid_modes = number_of_modes("subspace.rigid_modes", 0);
    report.zero_modes = file.metadata().contains("subspace.zero_modes")
                            ? number_of_modes("subspace.zero_modes", report.rigid_modes)
                            : report.rigid_modes;
    model.subspace = std::shared_ptr<const KroneckerBasis<block>>(std::move(basis));
  };
  model.subspace_name = file.metadata("subspace.name");
  const std::string& block = file.metadata("subspace.block");
  if (block == "3")
    load_basis(std::integral_constant<int, 3>{});
  else if (block == "1")
    load_basis(std::integral_constant<int, 1>{});
  else
    throw in.fail("subspace.block is '" + block + "', expected 1 or 3");

  try {  // what constructing the model demands: law, parameters, volumes
    const Index m = with_force_model(model.body, [](const auto& force) { return force->num_components(); });
    check_basis(in, model);
    model.indices = in.components("selection.indices", m);
    model.weights = in.positive_weights("selection.weights", model.indices);
  } catch (const std::invalid_argument& error) {
    throw in.fail(error.what());
  }
  model.rest_stiffness = in.finite_matrix("rest_stiffness", model.dim(), model.dim());
  const Matrix& K = model.rest_stiffness;
  if ((K - K.transpose()).norm() > 1e-8 * K.norm()) throw in.fail("rest_stiffness is not symmetric");
  if (file.contains("indicator.indices")) model.indicator = read_indicator(in, model);
  const AnySystem<Matrix> system = model.system();
  const Vector rest = Vector::Zero(model.dim());
  if (!system.force(rest).allFinite() || !std::isfinite(system.energy(rest)))
    throw in.fail("forces at rest are not finite: places, parameters, weights or the basis are out of all proportion");
  return model;
}

}  // namespace supple
