#pragma once
/// \file What a Checkpoint keeps of training and selection.

#include <core/tensor_file.hpp>
#include <reduction/training/relaxation.hpp>
#include <sparse/selection/selection.hpp>

namespace supple {

void store(TensorFileWriter& file, const FullStates& states);
void restore(const TensorFile& file, FullStates& states);

/// The stage of selection, and what it found on the way.
struct SelectedComponents {
  Selection selection;
  Index too_weak = 0;  ///< size of a smaller selection that was enough but for its stiffness at rest; 0: there was none
};
void store(TensorFileWriter& file, const SelectedComponents& selected);
void restore(const TensorFile& file, SelectedComponents& selected);

}  // namespace supple
