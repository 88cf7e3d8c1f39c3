#pragma once
/// \file What a Checkpoint keeps of the construction of subspaces.

#include <core/tensor_file.hpp>
#include <numerics/eigen/eigensolver.hpp>
#include <reduction/subspace/subspace.hpp>

namespace supple {

void store(TensorFileWriter& file, const EigenPairs& pairs);
void restore(const TensorFile& file, EigenPairs& pairs);

void store(TensorFileWriter& file, const DenseBasis& basis);
void restore(const TensorFile& file, DenseBasis& basis);

}  // namespace supple
