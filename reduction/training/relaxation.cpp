#include <core/parallel.hpp>
#include <numerics/linear/matrix_sums.hpp>
#include <numerics/optimize/bfgs_memory.hpp>
#include <reduction/training/relaxation.hpp>

#include <cmath>
#include <utility>

namespace supple {

Relaxation::Relaxation(Object object, const ReducedModes& modes)
    : object_(std::move(object)),
      rigid_(object_.lift(modes.Phi.leftCols(modes.num_zero))),
      spring_(modes.num_zero > 0 ? modes.softest_stiffness() : 0) {
  cholesky_.analyze(object_.K);
  // motions without energy that the subspace lacks show as a factorisation that fails
  for (const double shift : {0.5 * spring_, 1e-3 * modes.softest_stiffness()}) {
    SparseMatrix K = object_.K;
    add_diagonal(K, shift * object_.mass);
    if (cholesky_.factorize(K)) return;
  }
  throw SolverError("relaxation: K is not positive semi-definite at rest");
}

/// One minimisation on its way. Everything over the free unknowns.
struct Relaxation::Search {
  Index load;
  Vector start, u = start, gradient = {}, step = {};
  double value = 0, residual = 0;
  BlockRotations frames = {};
  BfgsMemory memory{8};
  bool ended = false;
};

struct Relaxation::Run {
  Matrix loads;  // M U λ, dim × count, or empty: then u keeps its part in the subspace
  double tolerance;
  Index max_iterations;
  bool in_complement() const { return loads.size() == 0; }
};

/// Potentials, and their gradients, in states of some searches.
struct Relaxation::Evaluated {
  Vector values;
  Matrix gradients;
  void give(Index k, Search& search) const {
    search.value = values[k];
    search.gradient = gradients.col(k);
  }
};

FullStates Relaxation::relaxed(const Matrix& Q, Index iterations) const {
  return run(Q, {}, 1e-6, iterations);
}

FullStates Relaxation::equilibria(const Matrix& loads, const Matrix& start, double tolerance,
                                  Index max_iterations) const {
  require_size("start.cols()", start.cols(), loads.cols());
  return run(start, loads, tolerance, max_iterations);
}

FullStates Relaxation::run(const Matrix& start, const Matrix& loads, double tolerance, Index max_iterations) const {
  const Index d = start.rows(), T = start.cols();
  FullStates states{Matrix(d, T), Matrix(d, T), Vector(T), Vector(T), Vector(T), Matrix(object_.mass.size(), T),
                    Vector(T)};
  constexpr Index at_once = 8;  // columns for which the solver reads its factor once
  for (Index begin = 0; begin < T; begin += at_once) {
    const Index count = std::min(at_once, T - begin);
    Run run{{}, tolerance, max_iterations};
    if (loads.size() > 0) run.loads = object_.mass.asDiagonal() * object_.lift(loads.middleCols(begin, count));
    const std::vector<Search> ends = minimise(object_.lift(start.middleCols(begin, count)), run);
    Matrix U(object_.mass.size(), count), f = U;
    for (Index k = 0; k < count; ++k) U.col(k) = ends[k].u;
    object_.forces(U, f, states.energies.segment(begin, count));
    const Matrix Q = object_.project(object_.mass.asDiagonal() * U);
    auto outside = states.remainders.middleCols(begin, count);
    outside = U - object_.lift(Q);
    states.Q.middleCols(begin, count) = Q;
    states.forces.middleCols(begin, count) = object_.project(f);
    for (Index k = 0; k < count; ++k) {
      states.sizes[begin + k] = size(ends[k].u);
      states.outside[begin + k] = size(outside.col(k)) / states.sizes[begin + k];
      states.residuals[begin + k] = ends[k].residual;
    }
  }
  return states;
}

constexpr Index turned_every = 8;  // iterations; frames hardly change in between

auto Relaxation::minimise(const Matrix& start, const Run& run) const -> std::vector<Search> {
  std::vector<Search> all;
  Searches going;
  for (Index k = 0; k < start.cols(); ++k) all.push_back({k, start.col(k)});
  for (Search& search : all) going.push_back(&search);
  const Evaluated at_start = evaluate(run, going, start);
  for (Search& search : all) at_start.give(search.load, search);
  for (Index iteration = 0; !going.empty(); ++iteration) {
    if (iteration % turned_every == 0) turn(going);
    find_steps(run, going);
    for (Search* search : going) search->ended = is_near_end(run, *search) || iteration == run.max_iterations;
    std::erase_if(going, [](const Search* search) { return search->ended; });
    advance(run, going);
    std::erase_if(going, [](const Search* search) { return search->ended; });
  }
  return all;
}

bool Relaxation::is_near_end(const Run& run, const Search& search) const {
  return !(search.residual > 1e-12 && size(search.step) > run.tolerance * size(search.u - search.start));
}

void Relaxation::turn(const Searches& searches) const {
  Matrix U(object_.mass.size(), searches.size());
  for (Index k = 0; k < U.cols(); ++k) U.col(k) = searches[k]->u;
  std::vector<BlockRotations> frames = object_.frames(U);
  for (Index k = 0; k < U.cols(); ++k) searches[k]->frames = std::move(frames[k]);
}

void Relaxation::find_steps(const Run& run, const Searches& searches) const {
  const auto count = static_cast<Index>(searches.size());
  Matrix G(object_.mass.size(), count);
  std::vector<std::vector<double>> coefficients(count);  // of the first loops of the memories
  parallel_for(count, [&](Index k) {
    Vector g = searches[k]->gradient;
    coefficients[k] = searches[k]->memory.first_loop(g);
    G.col(k) = g;
  });
  if (run.in_complement()) G -= object_.mass.asDiagonal() * object_.lift(object_.project(G));
  parallel_for(count, [&](Index k) { searches[k]->frames.turn_back(G.col(k)); });
  cholesky_.solve(G, G);
  parallel_for(count, [&](Index k) { searches[k]->frames.turn(G.col(k)); });
  if (run.in_complement()) G -= object_.lift(object_.project(object_.mass.asDiagonal() * G));
  parallel_for(count, [&](Index k) {
    Search& search = *searches[k];
    search.step = G.col(k);
    search.memory.second_loop(coefficients[k], search.step);
    search.step = -search.step;
    search.residual = size(search.step) / size(search.u);
  });
}

/// Goes along the steps as far as the potentials decrease; ends searches whose potential does not.
void Relaxation::advance(const Run& run, Searches searches) const {
  for (double t = 1; !searches.empty() && t > 1e-6; t *= 0.5) {
    Matrix trials(object_.mass.size(), searches.size());
    for (Index k = 0; k < trials.cols(); ++k) trials.col(k) = searches[k]->u + t * searches[k]->step;
    const Evaluated there = evaluate(run, searches, trials);
    Searches rejected;
    for (Index k = 0; k < trials.cols(); ++k) {
      Search& search = *searches[k];
      const double slope = search.gradient.dot(search.step), rounding = 1e-13 * std::abs(search.value);
      if (slope < 0 && there.values[k] <= search.value + 1e-4 * t * slope + rounding) {
        search.memory.add(trials.col(k) - search.u, there.gradients.col(k) - search.gradient);
        search.u = trials.col(k);
        there.give(k, search);
      } else {
        rejected.push_back(&search);
      }
    }
    searches = std::move(rejected);
  }
  for (Search* search : searches) {
    search->ended = search->memory.size() == 0;
    search->memory.clear();  // once more along the preconditioned gradient
  }
}

auto Relaxation::evaluate(const Run& run, const Searches& searches, const Matrix& U) const -> Evaluated {
  Evaluated result{Vector(U.cols()), Matrix(U.rows(), U.cols())};
  object_.forces(U, result.gradients, result.values);
  if (run.in_complement()) return result;
  for (Index k = 0; k < U.cols(); ++k) {
    const auto load = run.loads.col(searches[k]->load);
    result.values[k] -= load.dot(U.col(k));
    result.gradients.col(k) -= load;
  }
  if (spring_ > 0) {
    const Matrix held = rigid_.transpose() * (object_.mass.asDiagonal() * U);
    result.values += 0.5 * spring_ * held.colwise().squaredNorm().transpose();
    result.gradients += object_.mass.asDiagonal() * (spring_ * (rigid_ * held));
  }
  return result;
}

double Relaxation::size(VectorIn u) const {
  return std::sqrt(u.cwiseAbs2().dot(object_.mass));
}

}  // namespace supple
