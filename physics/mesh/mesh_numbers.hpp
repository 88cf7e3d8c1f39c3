#pragma once
/// \file Numbers by which messages call the parts of a mesh.

#include <cstdint>
#include <vector>

namespace supple {

/// The numbers that a file gives to nodes and elements, by which messages call them. Empty: by index. Cells are tets,
/// hexahedra and the like.
struct MeshNumbers {
  std::vector<std::int64_t> node = {}, cell = {}, triangle = {};
};

}  // namespace supple
