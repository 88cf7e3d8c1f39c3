#include <core/check.hpp>
#include <core/parallel.hpp>
#include <numerics/linear/spd_solver.hpp>
#include <numerics/optimize/bfgs_memory.hpp>
#include <reduction/training/exact_equilibria.hpp>

#include <cmath>
#include <limits>
#include <vector>

namespace supple {

namespace {

struct Search {
  Index load;
  Vector q, gradient = {}, step = {};
  double merit = 0;   // gᵀ K̃⁻¹ g
  double length = 1;  // share of the step to try
  double residual = std::numeric_limits<double>::quiet_NaN();
  SpdSolver<Matrix> tangent = {};
  BfgsMemory memory{20};

  double merit_of(VectorIn g) const { return g.dot(tangent.solve(g)); }
};

}  // namespace

ExactEquilibria exact_equilibria(const std::function<Matrix(MatrixIn Q)>& forces,
                                 const std::function<Matrix(VectorIn q)>& tangent, const Matrix& loads,
                                 const Matrix& springs, const Matrix& start, double tolerance, Index max_evaluations) {
  require_size("start.cols()", start.cols(), loads.cols());
  std::vector<Search> all;
  for (Index t = 0; t < start.cols(); ++t) all.push_back({t, start.col(t)});
  std::vector<Search*> going;
  for (Search& search : all) going.push_back(&search);

  const auto gradients = [&](const Matrix& Q) {
    Matrix G = forces(Q);
    if (springs.size() > 0) G += springs * Q;
    for (Index k = 0; k < Q.cols(); ++k) G.col(k) -= loads.col(going[k]->load);
    return G;
  };
  const Matrix G = gradients(start);
  parallel_for(start.cols(), [&](Index t) {
    Search& search = all[t];
    Matrix K = tangent(search.q);
    if (springs.size() > 0) K += springs;
    search.gradient = G.col(t);
    const bool definite = search.tangent.factorize(K);
    search.merit = definite ? search.merit_of(search.gradient) : std::numeric_limits<double>::quiet_NaN();
  });
  std::erase_if(going, [](const Search* search) { return !std::isfinite(search->merit); });

  const auto has_ended = [&](Search* search) {
    if (search->length < 1e-3) {  // no way down: once more along K̃⁻¹ g
      if (search->memory.size() == 0) return true;
      search->memory.clear();
      search->length = 1;
    }
    search->step = -search->memory.inverse_times(search->tangent, search->gradient);
    const double size = search->step.norm();
    search->residual = size / search->q.norm();
    return search->residual < 1e-10 || size < tolerance * (search->q - start.col(search->load)).norm();
  };
  for (Index evaluations = 1; evaluations < max_evaluations; ++evaluations) {
    std::erase_if(going, has_ended);
    if (going.empty()) break;
    Matrix trials(start.rows(), going.size());
    for (Index k = 0; k < trials.cols(); ++k) trials.col(k) = going[k]->q + going[k]->length * going[k]->step;
    const Matrix there = gradients(trials);
    for (Index k = 0; k < trials.cols(); ++k) {
      Search& search = *going[k];
      const double merit = search.merit_of(there.col(k));
      if (!(merit <= (1 - 1e-4 * search.length) * search.merit)) {  // true for NaN
        search.length *= 0.5;
        continue;
      }
      search.memory.add(trials.col(k) - search.q, there.col(k) - search.gradient);
      search.q = trials.col(k);
      search.gradient = there.col(k);
      search.merit = merit;
      search.length = 1;
    }
  }
  ExactEquilibria result{Matrix(start.rows(), start.cols()), Vector(start.cols())};
  for (const Search& search : all) {
    result.Q.col(search.load) = search.q;
    result.residuals[search.load] = search.residual;
  }
  return result;
}

}  // namespace supple
