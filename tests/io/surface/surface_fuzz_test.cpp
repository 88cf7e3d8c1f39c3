/// \file Damaged files: whatever the reader of surfaces meets, it answers with a sound mesh or an InputError,
/// and asks for no more memory than the file can justify.

#include <core/check.hpp>
#include <io/surface/surface_reader.hpp>
#include <tests/io/damage.hpp>
#include <tests/io/surface_files.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

namespace supple::test {
namespace {

class DamagedSurface : public testing::TestWithParam<MeshFile> {};

TEST_P(DamagedSurface, GivesASoundMeshOrAnInputError) {
  constexpr int num_files = 600;
  const std::filesystem::path folder = test_folder();
  Random random(11);
  int num_refused = 0;
  for (int k = 0; k < num_files; ++k) {
    MeshFile file = GetParam();
    file.bytes = damaged(std::move(file.bytes), random);
    const std::filesystem::path path = write(file, folder);
    forget_requests();
    try {
      MeshNotes notes;
      const TriangleMesh mesh = read_triangle_mesh(path, &notes);
      EXPECT_NO_THROW(check_mesh(mesh)) << "file " << k;
      EXPECT_EQ(static_cast<Index>(notes.numbers.node.size()), mesh.num_nodes());
      EXPECT_EQ(static_cast<Index>(notes.numbers.triangle.size()), mesh.num_triangles());
    } catch (const InputError&) {
      ++num_refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "file " << k << ": " << error.what();
    }
    EXPECT_LT(largest_request(), 100 * file.bytes.size() + 100000) << "file " << k;
  }
  EXPECT_GT(num_refused, num_files / 10);  // the damage does damage: half of an STL are normals, unread
  EXPECT_LT(num_refused, num_files);       // and not only at the door
}

INSTANTIATE_TEST_SUITE_P(Surface, DamagedSurface,
                         testing::ValuesIn(in_every_format(perturbed(equilateral_grid(2, 2), 0.01, 4))),
                         [](const auto& test) { return test.param.format; });

}  // namespace
}  // namespace supple::test
