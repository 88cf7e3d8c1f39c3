#pragma once
/// \file Problems with published answers, solved by full and reduced objects of ours.

#include <core/types.hpp>

#include <functional>
#include <string>
#include <vector>

namespace supple {

/// A number that somebody has published.
struct PublishedValue {
  std::string name, unit;
  double value;
};

/// What one refinement came to.
struct Validation {
  Index cells = 0, unknowns = 0;
  Vector full;  ///< one for each published value
  Index reduced_unknowns = 0;
  Vector reduced = {};  ///< the same of a reduced model of the command's defaults; empty: there is none
};

struct ValidationCase {
  std::string name, setup, source;
  std::vector<PublishedValue> values;
  std::vector<Index> levels;  ///< cells along the longest side, from coarse to fine
  std::function<Validation(Index level, bool with_reduced)> run;
  double tolerance = 0.01;  ///< of the full object on the finest level, relative
  std::string remark = {};  ///< why that is more, or what else there is to know
};

/// All of them, in the order of docs/validation.md.
std::vector<ValidationCase> validation_cases();

}  // namespace supple
