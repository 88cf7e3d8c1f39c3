#pragma once
/// \file Stress and tangent of any material: its own, or derived from its energy.

#include <core/recording.hpp>
#include <physics/material/materials.hpp>

#include <array>
#include <bit>
#include <type_traits>

namespace supple {

template <typename Material, typename Real>
concept HasStress = requires(const Material& material, const Matrix3<Real>& F) {
  { material.stress(F) } -> std::convertible_to<Matrix3<Real>>;
};
template <typename Material, typename Real>
concept HasTangent = requires(const Material& material, const Matrix3<Real>& F) {
  { material.tangent(F) } -> std::convertible_to<Matrix9<Real>>;
};

template <template <typename> class Material>
constexpr std::size_t num_material_parameters = sizeof(Material<double>) / sizeof(double);

/// A material of these parameters, in order of its members.
template <template <typename> class Material, typename Real>
Material<Real> material_of(const std::array<Real, num_material_parameters<Material>>& parameters) {
  static_assert(std::is_trivially_copyable_v<Material<Real>> && sizeof(Material<Real>) == sizeof(parameters),
                "a material must be an aggregate of members of type Real (or arrays of them) and nothing else");
  return std::bit_cast<Material<Real>>(parameters);
}
template <template <typename> class Material, typename Real>
std::array<Real, num_material_parameters<Material>> parameters_of(const Material<Real>& material) {
  return std::bit_cast<std::array<Real, num_material_parameters<Material>>>(material);
}

/// The formulas of a material, recorded and differentiated once in a process. Inputs of the programs are the
/// material's parameters and then F by columns.
template <template <typename> class Material>
class RecordedMaterial {
  static constexpr std::size_t num_parameters = num_material_parameters<Material>;

 public:
  /// P by columns, from the energy.
  static const Program& stress() {
    static const Program program = [] {
      Recorder recorder;
      return recorder.program(recorder.stress());
    }();
    return program;
  }
  /// The lower triangle of ∂P/∂F by columns, from the stress if the material has one, else from the energy.
  static const Program& tangent() {
    static const Program program = [] {
      Recorder recorder;
      std::vector<Recording::Handle> lower;
      const std::vector<Recording::Handle> P = recorder.stress();
      for (std::size_t column = 0; column < P.size(); ++column) {  // the row of ∂P/∂F, which is symmetric
        const auto part = recorder.recording.gradient(P[column], recorder.F().subspan(column));
        lower.insert(lower.end(), part.begin(), part.end());
      }
      return recorder.program(lower);
    }();
    return program;
  }
  template <typename Real, std::size_t num_outputs>
  static std::array<Real, num_outputs> run(const Program& program, const Material<Real>& material,
                                           const Matrix3<Real>& F) {
    std::array<Real, num_parameters + 9> inputs;
    std::ranges::copy(parameters_of(material), inputs.begin());
    std::copy_n(F.data(), 9, inputs.begin() + num_parameters);
    std::array<Real, num_outputs> outputs;
    program.run(inputs.data(), outputs.data());
    return outputs;
  }

 private:
  struct Recorder {
    Recording recording;
    RecordingScope scope{recording};
    std::vector<Recording::Handle> inputs;

    std::span<const Recording::Handle> F() const { return {inputs.data() + num_parameters, 9}; }
    std::vector<Recording::Handle> stress() {
      for (std::size_t k = 0; k < num_parameters + 9; ++k) inputs.push_back(recording.input());
      std::array<Recorded, num_parameters> parameters;
      for (std::size_t k = 0; k < num_parameters; ++k) parameters[k] = Recorded::of(inputs[k]);
      const Material<Recorded> material = material_of<Material>(parameters);
      Matrix3<Recorded> gradient;
      for (int k = 0; k < 9; ++k) gradient.data()[k] = Recorded::of(F()[k]);
      if constexpr (HasStress<Material<Recorded>, Recorded>) {
        const Matrix3<Recorded> P = material.stress(gradient);
        std::vector<Recording::Handle> result;
        for (int k = 0; k < 9; ++k) result.push_back(P.data()[k].node());
        return result;
      } else {
        return recording.gradient(material.energy(gradient).node(), F());
      }
    }
    Program program(const std::vector<Recording::Handle>& outputs) const { return {recording, inputs, outputs}; }
  };
};

/// P = ∂ψ/∂F [Pa]: the material's own formula, or that derived from its energy.
template <template <typename> class Material, typename Real>
Matrix3<Real> stress(const Material<Real>& material, const std::type_identity_t<Matrix3<Real>>& F) {
  if constexpr (HasStress<Material<Real>, Real>) {
    return material.stress(F);
  } else {
    using Formulas = RecordedMaterial<Material>;
    const std::array<Real, 9> P = Formulas::template run<Real, 9>(Formulas::stress(), material, F);
    return Eigen::Map<const Matrix3<Real>>(P.data());
  }
}

/// ∂P/∂F [Pa] over vec(F) by columns, 9 × 9, symmetric: the material's own, or that derived from its stress or energy.
template <template <typename> class Material, typename Real>
Matrix9<Real> tangent(const Material<Real>& material, const std::type_identity_t<Matrix3<Real>>& F) {
  if constexpr (HasTangent<Material<Real>, Real>) {
    return material.tangent(F);
  } else {
    using Formulas = RecordedMaterial<Material>;
    const std::array<Real, 45> lower = Formulas::template run<Real, 45>(Formulas::tangent(), material, F);
    Matrix9<Real> C;
    for (int column = 0, k = 0; column < 9; ++column)
      for (int row = column; row < 9; ++row) C(row, column) = C(column, row) = lower[k++];
    return C;
  }
}

}  // namespace supple
