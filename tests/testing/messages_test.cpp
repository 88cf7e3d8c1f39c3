// Suites are held to what they promise in turn: a model that is wrong in one way fails the one check that is about it,
// and the message says in words what is violated.
#include <physics/material/fung.hpp>
#include <physics/system/full_system.hpp>
#include <testing/force_model_conformance.hpp>
#include <testing/material_conformance.hpp>
#include <testing/subset_selector_conformance.hpp>
#include <testing/subspace_builder_conformance.hpp>
#include <tests/support/spring_network.hpp>

#include <gmock/gmock.h>

namespace supple::test {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::StrEq;

using Gradient = Matrix3<double>;
constexpr IsotropicModuli rubber{.young = 2e5, .poisson = 0.35};

/// The message of a check that fails.
std::string violation(const ::testing::AssertionResult& check) {
  return check ? "nothing is violated" : check.message();
}

TEST(Agree, NamesTheEntryThatIsFarthestOff) {
  Matrix expected = Matrix::Zero(2, 3), found = expected;
  const auto name = [](Index i, Index j) { return text("A", i, j); };
  EXPECT_TRUE(agree("claim", name, found, expected, 0));
  found(0, 1) = 0.5;
  found(1, 2) = -2;
  EXPECT_THAT(violation(agree("claim", name, found, expected, 0.1, " by hand")),
              StrEq("claim: A12: expected 0 by hand, found -2 (tolerance 0.1)"));
  EXPECT_TRUE(agree("claim", name, found, expected, 2));
  found(0, 0) = std::nan("");
  EXPECT_THAT(violation(agree("claim", name, found, expected, 2)), HasSubstr("A00: expected 0, found nan"));
  EXPECT_THAT(violation(agree("claim", name, expected, expected, std::nan(""))), HasSubstr("scale"));
  EXPECT_THAT(violation(agree("claim", name, expected, Matrix::Zero(3, 3), 1)),
              HasSubstr("expected 3 x 3 numbers, found 2 x 3"));
}

/// St. Venant–Kirchhoff, wrong in ways to choose.
enum class Fault { None, EnergyAtRest, Stress, Tangent, Asymmetry, Pack };
template <Fault fault>
struct Faulty {
  template <typename Real>
  struct Of {
    Real lambda, mu;
    StVenantKirchhoff<Real> whole() const { return {lambda, mu}; }
    Real energy(const Matrix3<Real>& F) const {
      Real psi = whole().energy(F);
      if (fault == Fault::EnergyAtRest) psi += mu;
      if (fault == Fault::Pack && std::same_as<Real, Pack>) psi *= Real(2);
      return psi;
    }
    Matrix3<Real> stress(const Matrix3<Real>& F) const {
      Matrix3<Real> P = whole().stress(F);
      if (fault == Fault::Stress) P(1, 2) *= Real(1.1);
      return P;
    }
    Matrix9<Real> tangent(const Matrix3<Real>& F) const {
      Matrix9<Real> C = whole().tangent(F);
      if (fault == Fault::Tangent) C(4, 4) *= Real(1.1);
      if (fault == Fault::Asymmetry) C(7, 0) += mu;
      return C;
    }
  };
  static MaterialPromises<Of> promises() {
    const auto [lambda, mu] = StVenantKirchhoff<double>::from(rubber);
    return MaterialPromises<Of>({lambda, mu});
  }
};
Gradient some_state() {
  return MaterialPromises<StVenantKirchhoff>::state(3);
}

TEST(MaterialMessages, NameTheDerivativeAndTheEntry) {
  const Gradient F = some_state(), R = random_rotation(4);
  EXPECT_THAT(violation(Faulty<Fault::Stress>::promises().stress_is_the_gradient_of_the_energy(F)),
              AllOf(StartsWith("material: stress is not the gradient of the energy: ∂ψ/∂F(1,2) = stress(F)(1,2): "
                               "expected "),
                    HasSubstr(" by differences of the energy at F = ["), HasSubstr(", found ")));
  EXPECT_THAT(violation(Faulty<Fault::Tangent>::promises().tangent_is_the_derivative_of_the_stress(F)),
              StartsWith("material: tangent is not the derivative of the stress: tangent(F)(4,4) = "
                         "∂P(1,1)/∂F(1,1): expected "));
  EXPECT_THAT(violation(Faulty<Fault::Asymmetry>::promises().tangent_is_symmetric(F)),
              AllOf(StartsWith("material: tangent is not symmetric: tangent(F)("), HasSubstr("7")));
  EXPECT_THAT(violation(Faulty<Fault::EnergyAtRest>::promises().rest_is_free_of_energy_and_stress(R)),
              StartsWith("material: there is energy at rest: energy(F): expected 0"));
  EXPECT_THAT(violation(Faulty<Fault::Pack>::promises().packs_equal_numbers()),
              StartsWith("material: lane 0 of a pack differs from the same numbers: energy(F)"));
  EXPECT_THAT(violation(Faulty<Fault::Stress>::promises().formulas_by_hand_equal_those_derived(F)),
              StartsWith("material: stress by hand is not that derived from the energy: ∂ψ/∂F(1,2)"));
  EXPECT_THAT(violation(Faulty<Fault::Tangent>::promises().formulas_by_hand_equal_those_derived(F)),
              StartsWith("material: tangent by hand is not that derived from the stress: tangent(F)(4,4)"));
  EXPECT_THAT(violation(Faulty<Fault::None>::promises().is_linear_elasticity_at_rest({.young = 1e5, .poisson = 0.35})),
              AllOf(StartsWith("material: is not linear elasticity of its moduli at rest: tangent(F)("),
                    HasSubstr("for Young's modulus 100000 and Poisson's ratio 0.35")));
  EXPECT_THAT(violation(refuses_impossible_moduli([](const IsotropicModuli& m) { return m.shear(); })),
              HasSubstr("from(young = 0, poisson = 0.3): expected std::invalid_argument, found a material"));
}

TEST(MaterialMessages, AreNotThereWhereNothingIsWrong) {
  const auto right = Faulty<Fault::None>::promises();
  const Gradient F = some_state(), R = random_rotation(4);
  EXPECT_TRUE(right.rest_is_free_of_energy_and_stress(R));
  EXPECT_TRUE(right.stress_is_the_gradient_of_the_energy(F));
  EXPECT_TRUE(right.tangent_is_the_derivative_of_the_stress(F));
  EXPECT_TRUE(right.tangent_is_symmetric(F));
  EXPECT_TRUE(right.is_objective(F, R));
  EXPECT_TRUE(right.is_isotropic(F, R));
  EXPECT_TRUE(right.is_linear_elasticity_at_rest(rubber));
  EXPECT_TRUE(right.packs_equal_numbers());
  EXPECT_TRUE(right.formulas_by_hand_equal_those_derived(F));
}

/// ψ = μ ‖F − I‖² takes a rotation for a strain.
template <typename Real>
struct Linear {
  Real mu;
  Real energy(const Matrix3<Real>& F) const {
    Matrix3<Real> D = F;
    for (int i = 0; i < 3; ++i) D(i, i) -= Real(1);
    return mu * D.squaredNorm();
  }
};
TEST(MaterialMessages, TellObserversFromDirections) {
  const Gradient F = some_state(), R = random_rotation(4);
  EXPECT_THAT(violation(MaterialPromises<Linear>({1e5}).is_objective(F, R)),
              StartsWith("material: is not objective (changes when the object is turned): energy(R F): expected "));
  const MaterialPromises<Fung> fibres(Fung<double>::from(rubber, 10, 4));
  EXPECT_TRUE(fibres.is_objective(F, R));
  EXPECT_THAT(violation(fibres.is_isotropic(F, R)),
              StartsWith("material: is not isotropic (changes when the undeformed"));
}

/// Two springs in a row, wrong in ways to choose.
class FaultySprings : public SpringNetwork {
 public:
  enum class Fault { None, Stencil, Rest, Force, Stiffness, Asymmetry };
  explicit FaultySprings(Fault fault) : SpringNetwork(nodes(), {{0, 1}, {1, 2}}, 100), fault_(fault) {}

  std::span<const Index, 2> stencil(Index i) const {
    static constexpr std::array<Index, 2> twice{2, 2};
    return fault_ == Fault::Stencil && i == 1 ? std::span<const Index, 2>(twice) : SpringNetwork::stencil(i);
  }
  Local<6> force(Index i, const Local<6>& u) const {
    Local<6> f = SpringNetwork::force(i, u);
    if (fault_ == Fault::Force && i == 1) f[4] *= 1.01;
    if (fault_ == Fault::Rest && i == 1) f[5] += 3;
    return f;
  }
  LocalMatrix<6> stiffness(Index i, const Local<6>& u) const {
    LocalMatrix<6> K = SpringNetwork::stiffness(i, u);
    if (fault_ == Fault::Stiffness && i == 1) K(2, 3) += 1;
    if (fault_ == Fault::Asymmetry && i == 1) K(0, 5) += 1;
    return K;
  }

 private:
  static Points nodes() {
    Points x(3, 3);
    x << 0, 0, 0, 0.1, 0.02, 0.01, 0.2, 0, 0.05;
    return x;
  }
  Fault fault_;
};
ForceModelPromises<FaultySprings> springs(FaultySprings::Fault fault) {
  return {std::make_shared<const FaultySprings>(fault), 0.1};
}

TEST(ForceModelMessages, NameComponentStateNodeAndAxis) {
  using enum FaultySprings::Fault;
  EXPECT_THAT(violation(springs(Stencil).stencil_is_of_distinct_nodes(1)),
              StrEq("force model: component 1: stencil: expected distinct nodes, found 2 twice"));
  EXPECT_THAT(violation(springs(Rest).is_in_equilibrium_at_rest(1)),
              StartsWith("force model: component 1, state 0: there is force at rest: force[5 (node 2, z)]: expected "
                         "0, found 3"));
  EXPECT_THAT(violation(springs(Force).force_is_the_gradient_of_the_energy(1, 2)),
              AllOf(StartsWith("force model: component 1, state 2: force is not the gradient of the energy: force[4 "
                               "(node 2, y)]: expected "),
                    HasSubstr(" by differences of the energy, found ")));
  EXPECT_THAT(violation(springs(Stiffness).stiffness_is_the_derivative_of_the_force(1, 0)),
              StartsWith("force model: component 1, state 0: stiffness is not the derivative of the force: "
                         "stiffness[2 (node 1, z)][3 (node 2, x)]: expected "));
  EXPECT_THAT(violation(springs(Asymmetry).tangent_is_symmetric(1, 1)),
              HasSubstr("component 1, state 1: stiffness is not symmetric: stiffness[5 (node 2, z)][0 (node 1, x)]"));
}

TEST(ForceModelMessages, TellTheFirstOfAllStatesOrNothing) {
  using enum FaultySprings::Fault;
  const auto gradient_of = [](const auto& model) {
    return model.in_all_states([&](Index i, int k) { return model.force_is_the_gradient_of_the_energy(i, k); });
  };
  EXPECT_THAT(violation(gradient_of(springs(Force))), StartsWith("force model: component 1, state 1: "));
  EXPECT_TRUE(gradient_of(springs(None)));
  EXPECT_TRUE(springs(None).pack_equals_its_terms({0, 1, 1, 0, 0, 0, 1, 1}, 2));
  EXPECT_TRUE(springs(None).translation_changes_nothing(1, 1));
  EXPECT_THAT(violation(springs(None).translation_changes_something()),
              HasSubstr("`static constexpr bool translation_invariant"));
}

TEST(SelectorMessages, NameWhatIsUnsound) {
  const Matrix A = uniform(12, 9, 1);
  const DenseProblem problem(A, A.rowwise().sum());
  SelectionRequest asked(3);
  asked.candidates = {1, 4, 5, 7};
  const Selection right = NnHtp{}(problem, asked);
  const auto after = [&](const auto& change) {
    Selection c = right;
    change(c);
    return is_sound(c, problem, asked, Signs::NonNegative, true);
  };
  EXPECT_TRUE(after([](Selection&) {}));
  EXPECT_THAT(violation(after([](Selection& c) { c.indices[0] = 9; })),
              StrEq("selector: indices[0]: expected a column 0 to 8, found 9"));
  EXPECT_THAT(violation(after([](Selection& c) { c.indices[0] = 0; })),
              HasSubstr("expected a candidate, found column 0"));
  EXPECT_THAT(violation(after([](Selection& c) { std::swap(c.indices[0], c.indices[1]); })),
              HasSubstr("the one before it"));
  EXPECT_THAT(violation(after([](Selection& c) { c.weights[0] = -2; })), HasSubstr("expected >= 0, found -2"));
  EXPECT_THAT(violation(after([](Selection& c) { c.weights[0] = 0; })), HasSubstr("column without weight"));
  EXPECT_THAT(violation(after([](Selection& c) { c.weights.conservativeResize(1); })),
              HasSubstr("weights: expected one for each"));
  EXPECT_THAT(violation(after([](Selection& c) { c.weights[0] *= 1.1; })),
              HasSubstr("report.residual: expected |A w - b| = "));
  EXPECT_THAT(violation(after([](Selection& c) { c.report.kkt_residual = 1e-3; })), HasSubstr("report.kkt_residual"));
  EXPECT_THAT(violation(after([](Selection& c) { c.report.stop_reason.clear(); })), HasSubstr("report.stop_reason"));
  asked.must_keep = {2};
  EXPECT_THAT(violation(is_sound(right, problem, asked, Signs::NonNegative, true)),
              HasSubstr("expected column 2, which it must keep, found none"));
}

TEST(SubspaceMessages, NameNodeAndColumn) {
  const FullSystem<FaultySprings> system(FaultySprings(FaultySprings::Fault::None), Vector::Constant(3, 0.25), {1});
  DenseBasis basis{RowMatrix::Zero(9, 2), {}};
  basis.W(0, 0) = basis.W(8, 1) = 2;  // 2² · 0.25 = 1
  EXPECT_TRUE(has_dimensions(basis, system));
  EXPECT_TRUE(is_mass_orthonormal(basis, system));
  EXPECT_TRUE(keeps_fixed_nodes(basis, system));

  DenseBasis wrong = basis;
  wrong.W(4, 1) = 0.1;
  EXPECT_THAT(violation(keeps_fixed_nodes(wrong, system)),
              StrEq("subspace: a fixed node moves: node 1, axis 1, column 1: expected 0, found 0.1"));
  wrong = basis;
  wrong.W(0, 1) = 1;
  EXPECT_THAT(violation(is_mass_orthonormal(wrong, system)),
              StartsWith("subspace: columns are not mass-orthonormal: u_1 . M u_0: expected 0, found 0.5"));
  wrong = basis;
  wrong.W(3, 0) = std::nan("");
  EXPECT_THAT(violation(has_dimensions(wrong, system)), HasSubstr("W(3, 0): expected a finite number, found nan"));
  wrong = {RowMatrix::Zero(6, 2), {}};
  EXPECT_THAT(violation(has_dimensions(wrong, system)), HasSubstr("rows: expected 9, unknowns of all nodes, found 6"));
}

}  // namespace supple::test
