#pragma once
/// \file Facts of an object that training needs beside its system.

#include <physics/body/body.hpp>
#include <reduction/pipeline/reduce_options.hpp>

#include <optional>
#include <string>
#include <string_view>

namespace supple {

/// What training needs to know of an object beside its system.
struct ObjectTraits {
  double diagonal;  ///< the length that amplitudes are shares of [m]
  InvertedPoses inverted;
  Index equilibria = 0;
  bool thin = false;  ///< buckles under large loads: equilibria have a third of them
  std::string component_name = "components";
};

/// Those of a body.
ObjectTraits traits_of(const Body& body, const ReduceOptions& options);

/// As many as the options say; otherwise a third of the random poses, none beside given ones nor for free shells, whose
/// forces would be a quarter further off.
Index num_equilibria(const Body& body, const ReduceOptions& options);

/// What becomes of poses with inverted tets of a material law: as asked for; otherwise Keep where the law's energy
/// is finite in such tets, else Shrink. \throws std::invalid_argument if Keep is asked for where it is not.
InvertedPoses inverted_rule(std::string_view law, std::optional<InvertedPoses> asked);

}  // namespace supple
