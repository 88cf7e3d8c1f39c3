#include <core/check.hpp>
#include <core/random.hpp>
#include <numerics/linear/symmetric_eigen.hpp>
#include <reduction/basis/joined_basis.hpp>
#include <reduction/basis/modal_derivatives.hpp>
#include <reduction/basis/pca_basis.hpp>
#include <reduction/basis/skinning_modes.hpp>
#include <reduction/basis/subspace_library.hpp>

#include <algorithm>
#include <cctype>
#include <cmath>

namespace supple {

namespace {

template <typename Basis>
AnyBasis share(Basis basis) {
  return std::make_shared<const Basis>(std::move(basis));
}

VibrationModes modes_of(const RestState& object, const SubspaceChoice& choice, Index count, const SubspaceRun& run) {
  VibrationModes modes;
  run.stage("vibration modes", [&] {
    modes = vibration_modes(object, {.num_modes = count,
                                     .tolerance = choice.tolerance,
                                     .seed = choice.seed,
                                     .progress = run.progress,
                                     .checkpoint = run.checkpoint});
  });
  return modes;
}

/// An entry without options.
NamedSubspace plain(std::string name, std::string description,
                    AnyBasis (*build)(const RestState&, const SubspaceChoice&, const SubspaceRun&)) {
  NamedSubspace entry{name, std::move(description), {}, {}};
  entry.build = [name, build](const RestState& object, const SubspaceChoice& choice, const OptionValues& options,
                              const SubspaceRun& run) {
    require(options.empty(),
            "subspace " + name + " has no options, found '" + (options.empty() ? "" : options[0].first) + "'");
    return build(object, choice, run);
  };
  return entry;
}

NamedSubspace extended() {
  return plain("extended", "modes under all linear maps",
               [](const RestState& object, const SubspaceChoice& choice, const SubspaceRun& run) {
                 object.require_space();
                 const VibrationModes modes = modes_of(object, choice, choice.modes, run);
                 AnyBasis basis;
                 run.stage("subspace",
                           [&] { basis = share(extend_modes(modes, object.positions, object.nodal_mass)); });
                 return basis;
               });
}

NamedSubspace modal() {
  return plain(
      "modal", "modes alone", [](const RestState& object, const SubspaceChoice& choice, const SubspaceRun& run) {
        VibrationModes modes = modes_of(object, choice, choice.dimension > 0 ? choice.dimension : choice.modes, run);
        return share(DenseBasis{std::move(modes.vectors), modes.report()});
      });
}

NamedSubspace derivatives() {
  return named_subspace(
      "derivatives", "modal derivatives",
      OptionsOf(ModalDerivatives{.affine_fields = true})
          .add("num_derivatives", &ModalDerivatives::num_derivatives,
               "leading components of the derivatives beside modes and free motions, without --dimension; 0: all")
          .add("num_pairs", &ModalDerivatives::num_pairs,
               "derivatives computed, of the pairs of modes with the largest weights; 0: of twice num_derivatives, or "
               "of all")
          .add("affine_fields", &ModalDerivatives::affine_fields, "whether free parts bring all 12 affine motions"),
      "modes and derivatives");
}

NamedSubspace skinning() {
  return plain("skinning", "skinning eigenmodes",
               [](const RestState& object, const SubspaceChoice& choice, const SubspaceRun& run) {
                 AnyBasis basis;
                 run.stage("skinning modes", [&] {
                   basis = share(SkinningModes{.num_weights = skinning_weights(choice),
                                               .tolerance = choice.tolerance,
                                               .seed = choice.seed,
                                               .progress = run.progress,
                                               .checkpoint = run.checkpoint}(object));
                 });
                 return basis;
               });
}

/// The parts of a name, each with its options.
std::vector<Choice> choices_of(const std::string& name) {
  std::vector<Choice> parts;
  for (std::size_t begin = 0; begin <= name.size();) {
    std::size_t end = name.find('+', begin);  // between parts, not in a number such as 1e+5
    while (end < name.size() && end + 1 < name.size() && std::isdigit(static_cast<unsigned char>(name[end + 1])))
      end = name.find('+', end + 1);
    end = std::min(end, name.size());
    Choice part = Choice::parse(name.substr(begin, end - begin));
    (void)subspaces().at(part.name);
    require(std::ranges::find(parts, part.name, &Choice::name) == parts.end(),
            "subspace '" + name + "' has '" + part.name + "' twice");
    parts.push_back(std::move(part));
    begin = end + 1;
  }
  return parts;
}

/// \throws SolverError naming the subspace, if its builder did not do what builders promise.
void require_promises(const std::string& name, const AnyBasis& basis, const RestState& object) {
  const auto expect = [&](bool holds, const std::string& what) {
    if (!holds) throw SolverError("subspace '" + name + "' broke its promise: it " + what);
  };
  std::visit(
      [&](const auto& subspace) {
        expect(subspace->dim() > 0, "has no dimension");
        expect(subspace->full_dim() == object.node_dim * object.numbering.num_nodes(),
               "has displacements of another number of nodes");
        expect(subspace->W.allFinite(), "has entries that are not finite");
        Random random(1);
        Vector q(subspace->dim());
        for (double& value : q) value = random.normal();
        const Vector u = subspace->reconstruct(q);
        for (const Index node : object.numbering.fixed_nodes())
          expect(u.segment(object.node_dim * node, object.node_dim).isZero(0),
                 "moves node " + std::to_string(node) + ", which is held");
        for (const Index i : object.numbering.held_unknowns()) {
          const Index node = object.numbering.free_nodes()[i / 3];
          expect(u[3 * node + i % 3] == 0,
                 "moves node " + std::to_string(node) + " along " + "xyz"[i % 3] + ", where it is held");
        }
        const double ratio = std::sqrt(u.cwiseAbs2().dot(object.mass_of_rows())) / q.norm();
        expect(std::abs(ratio - 1) < 1e-6, "is not orthonormal with respect to the masses");
      },
      basis);
}

/// The subspace without motions along axes that are held. Fields that act along all axes alike cannot respect that: the
/// basis becomes dense.
AnyBasis within_supports(const AnyBasis& basis, const RestState& object) {
  if (object.numbering.held_unknowns().empty()) return basis;
  return std::visit(
      [&](const auto& subspace) -> AnyBasis {
        if constexpr (std::remove_cvref_t<decltype(*subspace)>::block == 1) {
          return subspace;
        } else {
          RowMatrix U = subspace->dense();
          for (const Index i : object.numbering.held_unknowns())
            U.row(3 * object.numbering.free_nodes()[i / 3] + i % 3).setZero();
          Orthonormalized within = mass_orthonormalize(U, object.mass_of_rows());
          SubspaceReport report = subspace->report;
          report.dropped += within.dropped;
          return share(DenseBasis{std::move(within.W), std::move(report)});
        }
      },
      basis);
}

}  // namespace

Registry<NamedSubspace>& subspaces() {
  static Registry<NamedSubspace> all("subspace",
                                     {extended(), modal(), derivatives(), skinning(),
                                      named_subspace<PcaBasis>("pca", "principal components of snapshots")},
                                     ", or several with '+' between");
  return all;
}

std::vector<std::string> known_subspaces() {
  return subspaces().names();
}

std::vector<std::string> parts_of_subspace(const std::string& name) {
  std::vector<std::string> names;
  for (const Choice& part : choices_of(name)) names.push_back(part.name);
  return names;
}

void check(const SubspaceChoice& choice) {
  const std::vector<std::string> parts = parts_of_subspace(choice.name);
  for (const Choice& part : choices_of(choice.name)) {
    const std::vector<OptionInfo>& known = subspaces().at(part.name).options;
    for (const auto& [name, value] : part.options)
      require(std::ranges::find(known, name, &OptionInfo::name) != known.end(),
              "subspace " + part.name + " has no option '" + name + "', expected " +
                  (known.empty() ? "none" : "one of ") + listed(known, &OptionInfo::name));
  }
  require(parts.size() == 1 || choice.dimension == 0,
          "subspace '" + choice.name + "' has the dimensions of its parts, expected no other");
  require(choice.modes >= 1, "number of modes is " + std::to_string(choice.modes) + ", expected at least 1");
  require(choice.dimension >= 0, "dimension is " + std::to_string(choice.dimension) + ", expected 0 or more");
  require(std::ranges::find(parts, "pca") == parts.end() || choice.snapshots.size() > 0,
          "subspace 'pca' needs snapshots");
}

Index skinning_weights(const SubspaceChoice& choice) {
  return std::max<Index>(1, choice.dimension > 0 ? choice.dimension / 12 : (choice.modes + 1) / 2);
}

Index missing_rigid_motions(const RestState& object, const AnyBasis& basis) {
  const Index n = object.numbering.num_nodes();
  if (object.node_dim != 3 || object.positions.rows() != n) return 0;
  const FreeComponents parts = find_free_components(object.stencils, object.stencil_size, object.numbering);
  if (parts.free.empty()) return 0;
  const Vector mass = object.mass_of_rows();
  const Matrix rigid = mass_orthonormalize(RowMatrix(rigid_modes(object.positions, parts)), mass).W;
  Matrix outside(rigid.rows(), rigid.cols());
  std::visit(
      [&](const auto& subspace) {
        for (Index j = 0; j < rigid.cols(); ++j)
          outside.col(j) = rigid.col(j) - subspace->reconstruct(subspace->project(mass.cwiseProduct(rigid.col(j))));
      },
      basis);
  const Vector squares = symmetric_eigenvalues(outside.transpose() * mass.asDiagonal() * outside);
  return (squares.array() > 1e-12).count();
}

AnyBasis build_subspace(const RestState& object, const SubspaceChoice& choice, const SubspaceRun& run) {
  const std::vector<Choice> parts = choices_of(choice.name);
  const auto build = [&](const Choice& part) {
    const AnyBasis basis = within_supports(subspaces().at(part.name).build(object, choice, part.options, run), object);
    require_promises(part.name, basis, object);
    return basis;
  };
  AnyBasis sum = build(parts.front());
  for (std::size_t k = 1; k < parts.size(); ++k)
    sum = std::visit([&](const auto& first,
                         const auto& second) -> AnyBasis { return share(join(*first, *second, object.nodal_mass)); },
                     sum, build(parts[k]));
  if (const Index missing = missing_rigid_motions(object, sum); missing > 0)
    sum = std::visit(
        [&](const auto& basis) -> AnyBasis {
          auto noted = *basis;
          noted.report.notes.push_back("the subspace lacks " + std::to_string(missing) +
                                       " rigid motions of what nothing holds, which cannot move freely in it; in a sum "
                                       "with modes, such as modal+" +
                                       choice.name + ", it can");
          return share(std::move(noted));
        },
        sum);
  return sum;
}

}  // namespace supple
