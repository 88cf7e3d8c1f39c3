#include <physics/mesh/mass.hpp>
#include <physics/mesh/tet_mesh.hpp>

namespace supple {

Vector lumped_mass(const TetMesh& mesh, VectorIn density) {
  if (density.size() != 1) require_size("density", density.size(), mesh.num_cells());
  Vector mass = Vector::Zero(mesh.num_nodes());
  for (Index e = 0; e < mesh.num_cells(); ++e) {
    const double rho = density.size() == 1 ? density[0] : density[e];
    require(rho > 0, "density of tet " + std::to_string(e) + " is " + std::to_string(rho) + " kg/m^3, expected > 0");
    for (const Index v : mesh.cells[e]) mass[v] += rho * tet_volume(mesh, e) / 4;
  }
  return mass;
}

Vector lumped_mass(const TetMesh& mesh, double density) {
  return lumped_mass(mesh, Vector::Constant(1, density));
}

Vector lumped_heat_capacity(const TetMesh& mesh, double density, double specific_heat) {
  require(specific_heat > 0, "specific heat is " + std::to_string(specific_heat) + " J/(kg K), expected > 0");
  return specific_heat * lumped_mass(mesh, density);
}

Vector lumped_mass(const TriangleMesh& mesh, VectorIn density, VectorIn thickness) {
  if (density.size() != 1) require_size("density", density.size(), mesh.num_triangles());
  if (thickness.size() != 1) require_size("thickness", thickness.size(), mesh.num_triangles());
  Vector mass = Vector::Zero(mesh.num_nodes());
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    const double rho = density.size() == 1 ? density[0] : density[t];
    const double h = thickness.size() == 1 ? thickness[0] : thickness[t];
    require(rho > 0,
            "density of triangle " + std::to_string(t) + " is " + std::to_string(rho) + " kg/m^3, expected > 0");
    require(h > 0, "thickness of triangle " + std::to_string(t) + " is " + std::to_string(h) + " m, expected > 0");
    for (const Index v : mesh.triangles[t]) mass[v] += rho * h * triangle_area(mesh, t) / 3;
  }
  return mass;
}

Vector lumped_mass(const TriangleMesh& mesh, double density, double thickness) {
  return lumped_mass(mesh, Vector::Constant(1, density), Vector::Constant(1, thickness));
}

}  // namespace supple
