#include <reduction/basis/modal_basis.hpp>
#include <reduction/basis/subspace_library.hpp>
#include <reduction/pipeline/reduction.hpp>
#include <testing/near.hpp>
#include <tests/support/bars.hpp>

#include <gmock/gmock.h>

#include <atomic>

namespace supple::test {
namespace {

/// A structure of one's own: a NodalBasis that counts how often it is asked for displacements of all nodes.
struct CountingBasis {
  static constexpr int block = 3;
  RowMatrix W;
  SubspaceReport report;
  mutable std::shared_ptr<std::atomic<int>> reconstructions = std::make_shared<std::atomic<int>>(0);

  explicit CountingBasis(NodalBasis basis) : W(basis.W), report(basis.report), view_(std::move(basis)) {}
  Index dim() const { return view_.dim(); }
  Index full_dim() const { return view_.full_dim(); }
  Index num_fields() const { return view_.num_fields(); }
  Vector reconstruct(VectorIn q) const {
    ++*reconstructions;
    return view_.reconstruct(q);
  }
  Vector project(VectorIn f) const { return view_.project(f); }
  void add_row(Index dof, double scale, VectorOut sum) const { view_.add_row(dof, scale, sum); }
  double at(Index dof, VectorIn q) const { return view_.at(dof, q); }

 private:
  NodalBasis view_;
};
static_assert(Subspace<CountingBasis>);

TEST(Subspace, OfAStructureOfOnesOwnIsReducedToTheSameBits) {
  const auto full = std::make_shared<const StvkBar>(clamped_bar());
  const NodalBasis basis = ExtendedModalBasis{.num_modes = 3}(*full);
  ReduceOptions options{.points = 20, .held_out_poses = 10};
  options.poses.count = 20;
  options.equilibria = 4;
  const auto ours = reduce(full, std::make_shared<const NodalBasis>(basis), NnSp{}, options);
  const auto own = reduce(full, std::make_shared<const CountingBasis>(basis), NnSp{}, options);
  EXPECT_EQ(own.indices, ours.indices);
  EXPECT_TRUE(is_same(own.weights, ours.weights));
  const Vector q = Vector::LinSpaced(basis.dim(), -0.01, 0.02);
  const int before = *own.subspace->reconstructions;
  EXPECT_TRUE(is_same(own.system().force(q), ours.system().force(q)));
  EXPECT_EQ(*own.subspace->reconstructions, before) << "forces never touch the full mesh";
}

/// Two constant fields: the least that is a builder.
struct Constants {
  Index count = 1;
  DenseBasis operator()(const RestState& object) const {
    RowMatrix W = RowMatrix::Zero(object.mass_of_rows().size(), count);
    for (Index v : object.numbering.free_nodes())
      for (Index j = 0; j < count; ++j) W(object.node_dim * v + j, j) = 1;
    return {mass_orthonormalize(W, object.mass_of_rows()).W, {}};
  }
};

TEST(SubspaceLibrary, TakesABuilderOfOnesOwnWithItsOptions) {
  if (!subspaces().contains("constants"))
    subspaces().add(named_subspace("constants", "the same everywhere",
                                   OptionsOf<Constants>().add("count", &Constants::count, "axes")));
  const StvkBar bar = clamped_bar();
  const auto build = [&](const char* name) {
    return std::visit([](const auto& basis) { return basis->dim(); }, build_subspace(bar.rest_state(), {.name = name}));
  };
  EXPECT_EQ(build("constants"), 1);
  EXPECT_EQ(build("constants:count=2"), 2);
  EXPECT_EQ(build("constants:count=2+extended"), build("extended") + 2);
  EXPECT_THAT([&] { (void)build("constants:colour=red"); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("count")));
  EXPECT_THAT([&] { (void)build("extended:count=2"); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("no options")));
  EXPECT_THAT([&] { subspaces().add(named_subspace<Constants>("modal", "")); },
              testing::ThrowsMessage<std::invalid_argument>(testing::HasSubstr("'modal' already")));
}

/// Breaks one promise after the other.
struct Careless {
  enum class Way { Empty, NotFinite, Loose, TooLong };
  Way way;
  DenseBasis operator()(const RestState& object) const {
    DenseBasis basis = Constants{}(object);
    if (way == Way::Empty) basis.W.resize(basis.W.rows(), 0);
    if (way == Way::NotFinite)
      basis.W(3 * object.numbering.free_nodes()[0], 0) = std::numeric_limits<double>::infinity();
    if (way == Way::Loose) basis.W(3 * object.numbering.fixed_nodes()[0], 0) = 1;
    if (way == Way::TooLong) basis.W *= 1.001;
    return basis;
  }
};

TEST(SubspaceLibrary, RefusesABasisThatIsNone) {
  const StvkBar bar = clamped_bar();
  const auto refused = [&](Careless::Way way, const char* name, const char* reason) {
    subspaces().add(named_subspace(name, "", OptionsOf(Careless{way})));
    EXPECT_THAT(
        [&] { (void)build_subspace(bar.rest_state(), {.name = name}); },
        testing::ThrowsMessage<SolverError>(testing::AllOf(testing::HasSubstr(name), testing::HasSubstr(reason))));
  };
  refused(Careless::Way::Empty, "empty", "no dimension");
  refused(Careless::Way::NotFinite, "not-finite", "not finite");
  refused(Careless::Way::Loose, "loose", "which is held");
  refused(Careless::Way::TooLong, "too-long", "not orthonormal");
}

}  // namespace
}  // namespace supple::test
