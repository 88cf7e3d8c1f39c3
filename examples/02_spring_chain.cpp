// The smallest ForceModel of your own: a chain of springs, written in one page, integrated like any other object.
// (The library has springs between any nodes, SpringModel, whose terms also come in packs of eight.)
//
//   $ example_02_spring_chain
//   a chain of 20 springs swings for 2 s; energy drifts by 0.4 % of what was exchanged
#include <physics/system/full_system.hpp>
#include <physics/time/newmark.hpp>

#include <cmath>
#include <cstdio>

using namespace supple;

/// Springs between consecutive nodes: eᵢ = ½ k (|d| − L)² with d = (X + u)ᵢ₊₁ − (X + u)ᵢ.
class SpringChain {
 public:
  static constexpr int stencil_size = 2, node_dim = 3, local_dofs = 6;
  static constexpr bool translation_invariant = true;

  SpringChain(Index num_springs, double length, double stiffness) : length_(length), stiffness_(stiffness) {
    for (Index i = 0; i < num_springs; ++i) stencils_.push_back({i, i + 1});
  }

  Index num_nodes() const { return num_components() + 1; }
  Index num_components() const { return static_cast<Index>(stencils_.size()); }
  std::span<const Index, 2> stencil(Index i) const { return stencils_[i]; }

  double energy(Index, const Local<6>& u) const {
    const double stretch = current(u).norm() - length_;
    return 0.5 * stiffness_ * stretch * stretch;
  }
  Local<6> force(Index, const Local<6>& u) const {
    const Point d = current(u);
    const Point pull = stiffness_ * (1 - length_ / d.norm()) * d;
    Local<6> f;
    f << -pull, pull;
    return f;
  }
  LocalMatrix<6> stiffness(Index, const Local<6>& u) const {
    const Point d = current(u), t = d.normalized();
    const Matrix3<double> k =
        stiffness_ * ((1 - length_ / d.norm()) * (Matrix3<double>::Identity() - t * t.transpose()) + t * t.transpose());
    LocalMatrix<6> K;
    K << k, -k, -k, k;
    return K;
  }

 private:
  Point current(const Local<6>& u) const { return Point(length_, 0, 0) + u.tail<3>() - u.head<3>(); }

  double length_, stiffness_;
  std::vector<std::array<Index, 2>> stencils_;
};
static_assert(ForceModel<SpringChain>);

int main() {
  const Index springs = 20;
  const FullSystem system(SpringChain(springs, 0.05, 500.0), Vector::Constant(springs + 1, 0.01),
                          {0});  // held at one end
  Newmark newmark(system, 0.002);
  State state = State::at_rest(system.dim());
  const SystemLoad<SparseMatrix> gravity = system.project({.gravity = {0, -9.81, 0}});
  newmark.balance(gravity, state);

  double largest_drift = 0, exchanged = 0;
  for (int step = 0; step < 1000; ++step) {
    if (newmark.step(gravity, state).status != Status::Converged) return 1;
    const double work = gravity.force.dot(state.u);
    largest_drift = std::max(largest_drift, std::abs(newmark.energy(state) - work));
    exchanged = std::max(exchanged, std::abs(work));
  }
  std::printf("a chain of %td springs swings for %.0f s; energy drifts by %.1f %% of what was exchanged\n", springs,
              state.time, 100 * largest_drift / exchanged);
  return largest_drift < 0.05 * exchanged ? 0 : 1;
}
