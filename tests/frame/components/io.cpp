// A mesh is written and read again.
#include <io/builtin/builtin_meshes.hpp>
#include <io/frames/vtu_writer.hpp>

using namespace supple;

int main() {
  const TetMesh bar = builtin_mesh("bar:4x1x1");
  write_vtu("bar.vtu", bar.nodes, bar.cells);
  return read_tet_mesh("bar.vtu").num_cells() == bar.num_cells() ? 0 : 1;
}
