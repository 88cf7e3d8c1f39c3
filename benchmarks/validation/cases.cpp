#include <io/builtin/builtin_meshes.hpp>
#include <physics/body/body_system.hpp>
#include <physics/body/force_models.hpp>
#include <physics/body/surface_shares.hpp>
#include <physics/statics/static_solver.hpp>
#include <physics/system/full_system.hpp>
#include <physics/time/integrator_library.hpp>
#include <reduction/basis/modal_basis.hpp>
#include <reduction/pipeline/reduce.hpp>

#include <benchmarks/validation/cases.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace supple {

namespace {

constexpr double pi = std::numbers::pi;
using Cells = std::array<Index, 3>;
/// Quadratic tets of a unit box of cells, moved: (s, t, u) ∈ [0, 1]³ → x. Sides of cells follow curved edges.
template <typename Map>
QuadraticTetMesh mapped_box(const Cells& n, const Map& map) {
  TetMesh box = builtin_mesh("bar:" + std::to_string(n[0]) + "x" + std::to_string(n[1]) + "x" + std::to_string(n[2]));
  box.nodes = box.nodes * bounding_box(box.nodes).upper.cwiseInverse().asDiagonal();
  QuadraticTetMesh mesh = quadratic_mesh(box);
  for (Index v = 0; v < mesh.num_nodes(); ++v) mesh.nodes.row(v) = map(Point(mesh.nodes.row(v))).transpose();
  return mesh;
}

template <typename Holds>
std::vector<Index> nodes_where(const Points& nodes, const Holds& holds) {
  std::vector<Index> some;
  for (Index v = 0; v < nodes.rows(); ++v)
    if (holds(Point(nodes.row(v)))) some.push_back(v);
  return some;
}
Index nearest(const Points& nodes, const Point& at) {
  Index v = 0;
  (nodes.rowwise() - at.transpose()).rowwise().squaredNorm().minCoeff(&v);
  return v;
}

/// Slides along x and y alone: plane strain.
constexpr std::uint8_t along_z = 4;
std::vector<HeldAxes> all_but(const std::vector<Index>& fixed, Index num_nodes, std::uint8_t axes) {
  std::vector<HeldAxes> held;
  for (Index v = 0; v < num_nodes; ++v)
    if (!std::ranges::binary_search(fixed, v)) held.push_back({v, axes});
  return held;
}

/// A force shared out evenly over the faces between some nodes.
std::vector<NodalForce> spread(const Body& body, const std::vector<Index>& nodes, const Point& force) {
  const std::vector<SurfaceShare> shares = surface_shares(body, nodes);
  double area = 0;
  for (const SurfaceShare& share : shares) area += share.area;
  std::vector<NodalForce> forces;
  for (const SurfaceShare& share : shares) forces.push_back({share.node, share.area / area * force});
  return forces;
}

ReducedModel reduced(const Body& body) {
  ReduceOptions options = ReduceOptions::relaxed_derivatives();
  options.held_out_poses = 0;
  return reduce(body, options);
}

/// The equilibrium under loads that grow in steps. \return displacements of all nodes
template <typename MatrixType>
Vector settled(const AnySystem<MatrixType>& system, const Loads& loads, Index steps) {
  StaticSolver<AnySystem<MatrixType>> solver(system, {.tolerance = 1e-8, .max_iterations = 50});
  Vector u = Vector::Zero(system.dim());
  for (Index k = 1; k <= steps; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(steps);
    Loads part = loads;
    part.gravity *= share;
    for (NodalForce& load : part.forces) load.force *= share;
    const SolveReport report = solver.solve(system.project(part), u);
    if (!(report.residual <= 1e-6)) throw SolverError("no equilibrium found");
  }
  return system.expand(u);
}

using Read = std::function<Vector(const Vector& u)>;
Validation in_equilibrium(const Body& body, const Loads& loads, const Read& read, bool with_reduced, Index steps = 1) {
  const AnySystem<SparseMatrix> system = full_system(body);
  Validation result{.cells = num_cells(body), .unknowns = system.dim(), .full = read(settled(system, loads, steps))};
  if (with_reduced) {
    const ReducedModel model = reduced(body);
    result.reduced_unknowns = model.dim();
    result.reduced = read(settled(model.system(), loads, steps));
  }
  return result;
}

/// Calls visit(t, u) with the displacement of a node after each step from rest.
template <typename MatrixType, typename Visit>
void in_motion(const AnySystem<MatrixType>& system, const Loads& loads, Index node, double h, double end,
               const NonlinearSolver& solver, const Visit& visit) {
  auto integrator = make_integrator(Choice{"average-vector-field"}, system, h, {.solver = solver, .tolerance = 1e-8});
  State state = integrator.at_rest();
  const SystemLoad<MatrixType> load = system.project(loads);
  integrator.balance(load, state);
  for (Index k = 1; static_cast<double>(k) * h <= end + h / 2; ++k) {
    (void)integrator.step(load, state);
    visit(static_cast<double>(k) * h, system.displacement(state.u, node));
  }
}

// ---------------------------------------------------------------------------------------------------------------------

/// The tapered panel of Cook 1974 in large plane strain.
ValidationCase cook() {
  const auto run = [](Index n, bool with_reduced) {
    const QuadraticTetMesh mesh = mapped_box({n, n, 1}, [&](const Point& p) {
      const double s = p[0], t = p[1];
      return Point(0.048 * s, 0.044 * s + t * (0.044 - 0.028 * s), 0.044 / static_cast<double>(n) * p[2]);
    });
    QuadraticTetSolid solid =
        isotropic_solid(mesh, {.young = 1.0985e6, .poisson = 0.3},
                        nodes_where(mesh.nodes, [](const Point& x) { return x[0] < 1e-9; }), "mooney-rivlin");
    const double mu = 1.0985e6 / 2.6;
    solid.parameters << mu / 2, 0, 1.0985e6 / (3 * 0.4);  // neo-Hookean
    solid.held_axes = all_but(solid.fixed_nodes, mesh.num_nodes(), along_z);
    Loads loads;
    for (const SurfaceShare& share :
         surface_shares(Body(solid), nodes_where(mesh.nodes, [](const Point& x) { return x[0] > 0.048 - 1e-9; })))
      loads.forces.push_back({share.node, {0, 62.5e3 * share.area, 0}});
    const Index tip = nearest(mesh.nodes, {0.048, 0.052, 0});
    return in_equilibrium(
        solid, loads, [tip](const Vector& u) { return Vector::Constant(1, 1e3 * u[3 * tip + 1]); }, with_reduced, 2);
  };
  return {"Cook's membrane",
          "48 × 44/16 mm in plane strain, clamped left, sheared by 62.5 kPa on the right; neo-Hookean (Mooney–Rivlin "
          "with c₀₁ = 0), "
          "E 1.0985 MPa, ν 0.3; vertical displacement of the middle of the right edge",
          "Abaqus 14.73 mm, deal.II 14.74 mm",
          {{"tip", "mm", 14.73}},
          {8, 16, 32},
          run};
}

/// The bar behind the cylinder of Turek & Hron 2006.
struct TurekHron {
  double young;
  Validation operator()(Index n, bool with_reduced, bool in_time) const {
    const Index across = std::max<Index>(2, 2 * n / 35);
    const QuadraticTetMesh mesh = mapped_box({n, across, 1}, [&](const Point& p) {
      const double y = 0.02 * (p[1] - 0.5), left = std::sqrt(0.05 * 0.05 - y * y);
      return Point(left + p[0] * (0.4 - left), y, 0.01 * p[2]);
    });
    QuadraticTetSolid solid =
        isotropic_solid(mesh, {.young = young, .poisson = 0.4},
                        nodes_where(mesh.nodes, [](const Point& x) { return x.head<2>().norm() < 0.05 + 1e-9; }));
    solid.held_axes = all_but(solid.fixed_nodes, mesh.num_nodes(), along_z);
    const Loads weight{.gravity = {0, -2, 0}};
    const Index tip = nearest(mesh.nodes, {0.4, 0, 0});
    if (!in_time)
      return in_equilibrium(
          solid, weight, [tip](const Vector& u) { return Vector(1e3 * u.segment<2>(3 * tip)); }, with_reduced, 2);
    const auto swings = [&](const auto& system, const NonlinearSolver& solver) {
      Point low = Point::Constant(1e9), high = -low;
      in_motion(system, weight, tip, 0.005, 2, solver, [&](double, const Point& u) {
        low = low.cwiseMin(u);
        high = high.cwiseMax(u);
      });
      return Vector(500 *
                    (Vector(4) << high[0] + low[0], high[0] - low[0], high[1] + low[1], high[1] - low[1]).finished());
    };
    const AnySystem<SparseMatrix> system = full_system(Body(solid));
    Validation result{.cells = mesh.num_cells(), .unknowns = system.dim(), .full = swings(system, WarpedBfgs{})};
    if (with_reduced) {
      const ReducedModel model = reduced(solid);
      result.reduced_unknowns = model.dim();
      result.reduced = swings(model.system(), Bfgs{});
    }
    return result;
  }
};
ValidationCase csm(int number, double young, std::vector<PublishedValue> values) {
  const bool in_time = number == 3;
  return {"Turek–Hron CSM" + std::to_string(number),
          "bar 0.35 × 0.02 m behind the cylinder, plane strain, St. Venant–Kirchhoff, E " +
              std::string(young > 2e6 ? "5.6" : "1.4") + " MPa, ν 0.4, ρ 1000, gravity 2 m/s²; " +
              (in_time ? "let go at rest, 2 s in steps of 5 ms: mean and amplitude of the middle of the free end"
                       : "the middle of the free end"),
          "Turek & Hron 2006",
          std::move(values),
          {35, 70},
          [young, in_time](Index n, bool with_reduced) { return TurekHron{young}(n, with_reduced, in_time); },
          in_time ? 0.03 : 0.01,
          in_time ? "The swing along the bar is farther off than the equilibrium of CSM1, on the finer mesh more than "
                    "on the coarser one; why is not known yet."
                  : ""};
}

/// A thin cantilever under an end load, P L² / (E I) = 10.
ValidationCase elastica() {
  const auto run = [](Index n, bool with_reduced) {
    const double h = 0.01, young = 1e9, P = 10 * young * h * h * h * h / 12;
    const QuadraticTetMesh mesh =
        mapped_box({n, 1, 1}, [&](const Point& p) { return Point(p[0], h * (p[1] - 0.5), h * (p[2] - 0.5)); });
    const QuadraticTetSolid solid = isotropic_solid(
        mesh, {.young = young, .poisson = 0}, nodes_where(mesh.nodes, [](const Point& x) { return x[0] < 1e-9; }));
    Loads loads;
    loads.forces = spread(solid, nodes_where(mesh.nodes, [](const Point& x) { return x[0] > 1 - 1e-9; }), {0, P, 0});
    const Index tip = nearest(mesh.nodes, {1, 0, 0});
    return in_equilibrium(
        solid, loads, [tip](const Vector& u) { return Vector((Vector(2) << u[3 * tip + 1], -u[3 * tip]).finished()); },
        with_reduced, 10);
  };
  return {"elastica",
          "cantilever 1 × 0.01 × 0.01 m, ν 0, end load P with P L² / (E I) = 10; St. Venant–Kirchhoff",
          "Bisshopp & Drucker 1945, elliptic integrals",
          {{"v/L", "", 0.81061}, {"u/L", "", 0.55500}},
          {50, 100},
          run};
}

/// The 45° bend of Bathe & Bolourchi 1979.
ValidationCase bend() {
  const auto run = [](Index n, bool with_reduced) {
    const QuadraticTetMesh mesh = mapped_box({n, 1, 1}, [](const Point& p) {
      const double angle = p[0] * pi / 4, r = 100 + (p[1] - 0.5);
      return Point(100 - r * std::cos(angle), r * std::sin(angle), p[2] - 0.5);
    });
    const QuadraticTetSolid solid = isotropic_solid(
        mesh, {.young = 1e7, .poisson = 0}, nodes_where(mesh.nodes, [](const Point& x) { return x[1] < 1e-9; }));
    const Point end(100 - 100 * std::cos(pi / 4), 100 * std::sin(pi / 4), 0);
    const Point along(std::sin(pi / 4), std::cos(pi / 4), 0);  // of the axis at the end
    Loads loads;
    loads.forces = spread(solid, nodes_where(mesh.nodes, [&](const Point& x) { return (x - end).dot(along) > -1e-6; }),
                          {0, 0, 600});
    const Index tip = nearest(mesh.nodes, end);
    return in_equilibrium(
        solid, loads, [tip](const Vector& u) { return Vector(u.segment<3>(3 * tip)); }, with_reduced, 6);
  };
  return {"45° bend",
          "radius 100, section 1 × 1, E 10⁷, ν 0, 600 across the plane at the end; x towards the centre, y along the "
          "clamped end",
          "Bathe & Bolourchi 1979",
          {{"x", "in", -13.4}, {"y", "in", -23.5}, {"z", "in", 53.4}},
          {20, 40},
          run,
          0.02,
          "The published x is of eight straight beam elements and has three digits; later ones find 13.6 and 13.7."};
}

/// MacNeal & Harder's beam, twisted by 90°.
ValidationCase twisted_beam() {
  const auto run = [](Index n, bool with_reduced) {
    const QuadraticTetMesh mesh = mapped_box({n, std::max<Index>(1, n / 6), 1}, [](const Point& p) {
      const double angle = p[0] * pi / 2, w = 1.1 * (p[1] - 0.5), h = 0.32 * (p[2] - 0.5);
      return Point(12 * p[0], w * std::cos(angle) - h * std::sin(angle), w * std::sin(angle) + h * std::cos(angle));
    });
    const QuadraticTetSolid solid = isotropic_solid(
        mesh, {.young = 29e6, .poisson = 0.22}, nodes_where(mesh.nodes, [](const Point& x) { return x[0] < 1e-9; }));
    const std::vector<Index> end = nodes_where(mesh.nodes, [](const Point& x) { return x[0] > 12 - 1e-9; });
    const Index tip = nearest(mesh.nodes, {12, 0, 0});
    Validation result;
    for (const Point& load : {Point(0, 0, 1), Point(0, 1, 0)}) {
      Loads loads;
      loads.forces = spread(solid, end, load);
      const Validation one = in_equilibrium(
          solid, loads, [&](const Vector& u) { return Vector::Constant(1, 1e3 * load.dot(u.segment<3>(3 * tip))); },
          with_reduced);
      result.cells = one.cells;
      result.unknowns = one.unknowns;
      result.reduced_unknowns = one.reduced_unknowns;
      const auto append = [](Vector& to, const Vector& from) {
        to.conservativeResize(to.size() + from.size());
        to.tail(from.size()) = from;
      };
      append(result.full, one.full);
      append(result.reduced, one.reduced);
    }
    return result;
  };
  return {"twisted beam",
          "12 × 1.1 × 0.32 in, twisted by 90°, E 29·10⁶ psi, ν 0.22; unit loads at the end across the thickness and "
          "along the "
          "width of the clamped end, displacement along the load",
          "MacNeal & Harder 1985",
          {{"across", "10⁻³ in", 5.424}, {"along", "10⁻³ in", 1.754}},
          {12, 24},
          run};
}

/// NAFEMS FV52: a thick plate whose lower edges do not move across it.
ValidationCase thick_plate() {
  const auto run = [](Index n, bool) {
    const QuadraticTetMesh mesh = mapped_box({n, n, std::max<Index>(1, n / 10)},
                                             [](const Point& p) { return Point(10 * p[0], 10 * p[1], p[2]); });
    QuadraticTetSolid solid = isotropic_solid(mesh, {.young = 200e9, .poisson = 0.3}, {}, "stvk", 8000);
    for (Index v = 0; v < mesh.num_nodes(); ++v) {
      const Point x = mesh.nodes.row(v);
      const bool at_edge = x.head<2>().minCoeff() < 1e-9 || x.head<2>().maxCoeff() > 10 - 1e-9;
      if (at_edge && x[2] < 1e-9) solid.held_axes.push_back({v, along_z});
    }
    return with_force_model(Body(solid), [&]<typename Model>(const std::shared_ptr<const Model>& model) {
      const FullSystem<Model> system(model, solid.nodal_mass(), {}, solid.held_axes);
      const VibrationModes modes = vibration_modes(system.rest_state(), {.num_modes = 10});
      return Validation{.cells = mesh.num_cells(), .unknowns = system.dim(), .full = modes.omega.tail(7) / (2 * pi)};
    });
  };
  return {"NAFEMS FV52",
          "plate 10 × 10 × 1 m, E 200 GPa, ν 0.3, ρ 8000, lower edges held across the plate alone: frequencies behind "
          "three motions "
          "without energy",
          "NAFEMS, Selected Benchmarks for Natural Frequency Analysis, 1987",
          {{"4", "Hz", 45.897},
           {"5", "Hz", 109.44},
           {"6", "Hz", 109.44},
           {"7", "Hz", 167.89},
           {"8", "Hz", 193.59},
           {"9", "Hz", 206.19},
           {"10", "Hz", 206.19}},
          {8, 16},
          run,
          0.06,
          "The published values are of plate theory. In three dimensions lines alone hold the edges, and the finer the "
          "mesh, the softer they are."};
}

/// Rows of nearly equilateral triangles on [−margin, length] × [0, width]: the rows x < 0 hold the slope of a clamped edge.
struct Strip {
  TriangleMesh mesh;
  std::vector<Index> held;
};
enum class StripMesh { Equilateral, RightAngled };
Strip clamped_strip(double length, double width, Index across, StripMesh kind) {
  const double edge = width / static_cast<double>(across);
  const double step = kind == StripMesh::Equilateral ? edge * std::sqrt(0.75) : edge;
  const Index rows = static_cast<Index>(std::llround(length / step));
  Strip strip;
  std::vector<std::vector<double>> y;  // of the nodes of each row
  for (Index i = -1; i <= rows; ++i) {
    std::vector<double>& row = y.emplace_back();
    const bool shifted = kind == StripMesh::Equilateral && i % 2 != 0;
    if (!shifted)
      for (Index j = 0; j <= across; ++j) row.push_back(edge * static_cast<double>(j));
    else {
      row.push_back(0);
      for (Index j = 0; j < across; ++j) row.push_back(edge * (static_cast<double>(j) + 0.5));
      row.push_back(width);
    }
  }
  std::vector<std::vector<Index>> number;
  std::vector<Point> nodes;
  for (std::size_t r = 0; r < y.size(); ++r) {
    std::vector<Index>& row = number.emplace_back();
    for (const double at : y[r]) {
      row.push_back(static_cast<Index>(nodes.size()));
      nodes.emplace_back((static_cast<double>(r) - 1) * length / static_cast<double>(rows), at, 0);
      if (r <= 1) strip.held.push_back(row.back());
    }
  }
  for (std::size_t r = 0; r + 1 < y.size(); ++r) {  // between two rows: advance where the next node is nearer
    std::size_t a = 0, b = 0;
    const auto &low = number[r], &high = number[r + 1];
    bool turn = false;
    while (a + 1 < low.size() || b + 1 < high.size()) {
      const bool can_a = a + 1 < low.size(), can_b = b + 1 < high.size();
      bool first = can_a && (!can_b || y[r][a + 1] < y[r + 1][b + 1] - 1e-12);
      if (can_a && can_b && std::abs(y[r][a + 1] - y[r + 1][b + 1]) < 1e-12) first = turn = !turn;
      if (first) {
        strip.mesh.triangles.push_back({low[a], high[b], low[a + 1]});
        ++a;
      } else {
        strip.mesh.triangles.push_back({low[a], high[b], high[b + 1]});
        ++b;
      }
    }
  }
  strip.mesh.nodes.resize(static_cast<Index>(nodes.size()), 3);
  for (std::size_t v = 0; v < nodes.size(); ++v) strip.mesh.nodes.row(static_cast<Index>(v)) = nodes[v].transpose();
  return strip;
}

/// NAFEMS FV16: a square cantilever plate, as a discrete shell.
ValidationCase thin_plate(StripMesh kind) {
  const auto run = [kind](Index n, bool) {
    const Strip strip = clamped_strip(10, 10, n, kind);
    const Shell shell = isotropic_shell(strip.mesh, {.young = 200e9, .poisson = 0.3}, 0.05, strip.held, 8000);
    return with_force_model(Body(shell), [&]<typename Model>(const std::shared_ptr<const Model>& model) {
      const FullSystem<Model> system(model, shell.nodal_mass(), shell.fixed_nodes);
      const VibrationModes modes = vibration_modes(system.rest_state(), {.num_modes = 6});
      return Validation{.cells = num_cells(Body(shell)), .unknowns = system.dim(), .full = modes.omega / (2 * pi)};
    });
  };
  return {std::string("NAFEMS FV16, shell of ") + (kind == StripMesh::Equilateral ? "equilateral" : "right-angled") +
              " triangles",
          "cantilever plate 10 × 10 × 0.05 m, E 200 GPa, ν 0.3, ρ 8000; two rows of nodes hold the slope of the "
          "clamped edge",
          "NAFEMS, Selected Benchmarks for Natural Frequency Analysis, 1987",
          {{"1", "Hz", 0.4179},
           {"2", "Hz", 1.0242},
           {"3", "Hz", 2.5627},
           {"4", "Hz", 3.2749},
           {"5", "Hz", 3.7271},
           {"6", "Hz", 6.5241}},
          {10, 20, 40},
          run};
}

/// Sze, Liu & Lo 2004: a cantilever shell under an end force.
ValidationCase shell_cantilever(StripMesh kind) {
  const auto run = [kind](Index n, bool) {
    const Strip strip = clamped_strip(10, 1, n, kind);
    const Shell shell = isotropic_shell(strip.mesh, {.young = 1.2e6, .poisson = 0}, 0.1, strip.held);
    Loads loads;
    std::vector<Index> end = nodes_where(strip.mesh.nodes, [](const Point& x) { return x[0] > 10 - 1e-9; });
    double width = 0;
    std::vector<double> share(end.size(), 0);  // of the edge
    for (std::size_t k = 0; k + 1 < end.size(); ++k) {
      const double part = strip.mesh.nodes(end[k + 1], 1) - strip.mesh.nodes(end[k], 1);
      share[k] += part / 2, share[k + 1] += part / 2, width += part;
    }
    for (std::size_t k = 0; k < end.size(); ++k) loads.forces.push_back({end[k], {0, 0, 4 * share[k] / width}});
    const Index tip = nearest(strip.mesh.nodes, {10, 0.5, 0});
    return in_equilibrium(
        shell, loads, [tip](const Vector& u) { return Vector((Vector(2) << u[3 * tip + 2], -u[3 * tip]).finished()); },
        false, 10);
  };
  return {std::string("Sze's cantilever, shell of ") +
              (kind == StripMesh::Equilateral ? "equilateral" : "right-angled") + " triangles",
          "10 × 1, thickness 0.1, E 1.2·10⁶, ν 0, end force 4",
          "Sze, Liu & Lo 2004",
          {{"w", "", 6.698}, {"u", "", 3.286}},
          {2, 4, 8},
          run};
}

}  // namespace

/// Discrete shells converge to the theory of thin shells on some meshes only.
ValidationCase as_a_shell(ValidationCase what, double tolerance) {
  what.tolerance = tolerance;
  what.remark =
      "Bending of a discrete shell is a sum over flaps. It comes to the theory of plates where it bends one way, "
      "slowly; where it twists it does not, and is the farther off the more the triangles are cut alike.";
  return what;
}

std::vector<ValidationCase> validation_cases() {
  return {cook(),
          csm(1, 1.4e6, {{"ux", "mm", -7.1877}, {"uy", "mm", -66.102}}),
          csm(2, 5.6e6, {{"ux", "mm", -0.46900}, {"uy", "mm", -16.974}}),
          csm(3, 1.4e6,
              {{"mean of ux", "mm", -14.305},
               {"amplitude of ux", "mm", 14.305},
               {"mean of uy", "mm", -63.607},
               {"amplitude of uy", "mm", 65.160}}),
          elastica(),
          bend(),
          twisted_beam(),
          thick_plate(),
          as_a_shell(thin_plate(StripMesh::Equilateral), 0.25),
          as_a_shell(thin_plate(StripMesh::RightAngled), 0.65),
          as_a_shell(shell_cantilever(StripMesh::Equilateral), 0.1),
          as_a_shell(shell_cantilever(StripMesh::RightAngled), 0.1)};
}

}  // namespace supple
