#include <core/random.hpp>
#include <io/builtin/builtin_meshes.hpp>
#include <physics/body/force_models.hpp>
#include <tests/fuzz/small_models.hpp>
#include <tests/support/meshes.hpp>

#include <Eigen/QR>

namespace supple::fuzz {

namespace {

template <typename Mesh>
Body small_solid(const char* spec, std::string_view law, SolidComponent component) {
  Mesh mesh = std::get<Mesh>(builtin_solid_mesh(spec));
  for (Index e = 0; e < mesh.num_cells(); ++e) mesh.region.push_back(2 * e < mesh.num_cells() ? 1 : 2);
  mesh.region_names = {{1, "left"}, {2, "right"}};
  auto solid = isotropic_solid(std::move(mesh), {.young = 1e5, .poisson = 0.3}, {0, 1}, law);
  solid.component = component;
  solid.material_of_cell.assign(static_cast<std::size_t>(solid.mesh.num_cells()), 0);
  return solid;
}

template <int block>
std::shared_ptr<const KroneckerBasis<block>> random_basis(const Body& body) {
  auto basis = std::make_shared<KroneckerBasis<block>>();
  const Index rows_of_node = 3 / block;
  const Vector mass = nodal_mass(body).replicate(1, rows_of_node).transpose().reshaped();
  Random random(5);
  Matrix X = Matrix::NullaryExpr(mass.size(), 2 * rows_of_node, [&] { return random.normal(); });
  for (const Index v : fixed_nodes(body)) X.middleRows(v * rows_of_node, rows_of_node).setZero();
  const Matrix Q = Eigen::HouseholderQR<Matrix>(X).householderQ() * Matrix::Identity(X.rows(), X.cols());
  basis->W = mass.cwiseSqrt().cwiseInverse().asDiagonal() * Q;
  for (const Index v : fixed_nodes(body)) basis->W.middleRows(v * rows_of_node, rows_of_node).setZero();
  basis->report.omega = Vector::LinSpaced(3, 10, 30);
  basis->report.residuals = Vector::Constant(3, 1e-9);
  return basis;
}

}  // namespace

std::vector<Body> small_bodies() {
  std::vector<Body> bodies{
      small_solid<TetMesh>("bar:1x1x1", "stvk", SolidComponent::Element),
      small_solid<HexMesh>("hexbox:4x1x1", "neo-hookean", SolidComponent::GaussPoint),
      small_solid<QuadraticTetMesh>("tet10:bar:1x1x1", "stable-neo-hookean", SolidComponent::Element),
      isotropic_shell(test::equilateral_grid(3, 2), {.young = 1e6, .poisson = 0.3}, 0.01, {0, 1})};
  return bodies;
}

ReducedModel small_model(const Body& body, int block) {
  ReducedModel model;
  model.body = body;
  if (block == 3)
    model.subspace = random_basis<3>(body);
  else
    model.subspace = random_basis<1>(body);
  model.provenance = {{"seed", "1"}, {"training_error", "0.01"}};
  model.rest_stiffness = 100 * Matrix::Identity(model.dim(), model.dim());
  model.indices = {0, 2, 3};
  model.weights = Vector::LinSpaced(3, 1, 2);
  const Index rows = with_force_model(
      body, []<typename Model>(const std::shared_ptr<const Model>&) { return Index{num_active_dofs<Model>}; });
  model.indicator = ErrorIndicator{.indices = {1},
                                   .weights = Vector::Ones(1),
                                   .rows = RowMatrix::Constant(rows, model.dim() + 1, 0.1),
                                   .outside_stiffness = Vector::Constant(1, 1e3),
                                   .trained_size = 0.5};
  return model;
}

Trajectory small_trajectory(const std::filesystem::path& model, bool reduced) {
  const Index frames = 3, coordinates = reduced ? load_model(model).dim() : 3 * num_nodes(load_model(model).body);
  Trajectory trajectory;
  trajectory.reduced = reduced;
  trajectory.model = model;
  trajectory.model_checksum = header_checksum(model);
  trajectory.step = 0.01;
  trajectory.steps_per_second = 1e4;
  trajectory.time = Vector::LinSpaced(frames, 0, 0.02);
  trajectory.kinetic = trajectory.elastic = trajectory.work = Vector::Ones(frames);
  trajectory.u = trajectory.v = RowMatrix::Constant(frames, coordinates, 1e-3);
  return trajectory;
}

}  // namespace supple::fuzz
