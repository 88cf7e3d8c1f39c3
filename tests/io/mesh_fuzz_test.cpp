/// \file Damaged files: whatever a reader meets, it answers with a sound mesh or an InputError, and asks for
/// no more memory than the file can justify.

#include <core/check.hpp>
#include <core/random.hpp>
#include <io/builtin_meshes.hpp>
#include <io/mesh_reader.hpp>
#include <tests/io/mesh_files.hpp>
#include <tests/support/meshes.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>
#include <new>

namespace {
std::atomic<std::size_t> largest_request = 0;
}

[[gnu::noinline]] void* operator new(std::size_t size) {
  std::size_t largest = largest_request;
  while (size > largest && !largest_request.compare_exchange_weak(largest, size)) {
  }
  if (void* memory = std::malloc(size > 0 ? size : 1)) return memory;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* memory) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}

namespace supple::test {
namespace {

TetMesh small_mesh() {
  TetMesh mesh = perturbed(builtin_mesh("bar:2x1x1"), 0.05, 2);
  for (Index e = 0; e < mesh.num_tets(); ++e) mesh.region.push_back(1 + static_cast<int>(e) / 6);
  mesh.region_names = {{1, "left"}, {2, "right"}};
  return mesh;
}

/// One to three random changes: bits, bytes, numbers, missing, repeated and exchanged pieces.
std::string damaged(std::string bytes, Random& random) {
  static const std::vector<std::string> tokens{"-1",
                                               "0",
                                               "99999999999",
                                               "18446744073709551615",
                                               "nan",
                                               "1e999",
                                               "$Nodes",
                                               "End",
                                               "\n",
                                               " ",
                                               "4611686018427387904",
                                               "#",
                                               "\"",
                                               "<",
                                               "_",
                                               "*SET",
                                               std::string("\0", 1),
                                               std::string("\xff\xff\xff\xff", 4),
                                               std::string("\0\0\0\x40", 4),
                                               std::string("\xff\xff\xff\x7f", 4)};
  for (Index change = 1 + random.below(3); change > 0 && !bytes.empty(); --change) {
    const auto size = static_cast<Index>(bytes.size());
    const Index at = random.below(size), length = 1 + random.below(std::min<Index>(size - at, 40));
    switch (random.below(8)) {
      case 0:
        bytes[at] = static_cast<char>(bytes[at] ^ (1 << random.below(8)));
        break;
      case 1:
        bytes[at] = static_cast<char>(random.below(256));
        break;
      case 2:
        bytes.erase(at, length);
        break;
      case 3:
        bytes.insert(at, bytes.substr(random.below(size), length));
        break;
      case 4:
        bytes.resize(at);
        break;
      case 5:
        bytes.replace(at, std::min(length, Index{8}),
                      tokens[random.below(static_cast<Index>(tokens.size()))]);
        break;
      case 6:
        bytes.insert(at, tokens[random.below(static_cast<Index>(tokens.size()))]);
        break;
      case 7: {  // another number in place of one of the text
        const std::size_t begin = bytes.find_first_of("0123456789", at);
        if (begin == std::string::npos) break;
        const std::size_t end = std::min(bytes.find_first_not_of("0123456789", begin), bytes.size());
        bytes.replace(begin, end - begin, tokens[random.below(6)]);
        break;
      }
    }
  }
  return bytes;
}

class DamagedFile : public testing::TestWithParam<MeshFile> {};

TEST_P(DamagedFile, GivesASoundMeshOrAnInputError) {
  constexpr int num_files = 400;
  const std::filesystem::path folder = test_folder();
  Random random(7);
  int num_refused = 0;
  for (int k = 0; k < num_files; ++k) {
    MeshFile file = GetParam();
    const bool is_ele = file.extension == ".node" && k % 2 == 0;
    std::string& bytes = is_ele ? file.ele_bytes : file.bytes;
    bytes = damaged(std::move(bytes), random);
    const std::filesystem::path path = write(file, folder);
    largest_request = 0;
    try {
      MeshNotes notes;
      const TetMesh mesh = read_tet_mesh(path, &notes);
      EXPECT_NO_THROW(check_mesh(mesh)) << "file " << k;
      EXPECT_EQ(static_cast<Index>(notes.numbers.node.size()), mesh.num_nodes());
      EXPECT_EQ(static_cast<Index>(notes.numbers.tet.size()), mesh.num_tets());
    } catch (const InputError&) {
      ++num_refused;
    } catch (const std::exception& error) {
      ADD_FAILURE() << "file " << k << ": " << error.what();
    }
    // Deflated data may unfold a thousandfold, anything else to a number for each byte or two.
    EXPECT_LT(largest_request, 1100 * (file.bytes.size() + file.ele_bytes.size()) + 100000) << "file " << k;
  }
  EXPECT_GT(num_refused, num_files / 4);  // the damage does damage
  EXPECT_LT(num_refused, num_files);      // and not only at the door
}

INSTANTIATE_TEST_SUITE_P(Mesh, DamagedFile, testing::ValuesIn(in_every_format(small_mesh())),
                         [](const auto& test) { return test.param.format; });

}  // namespace
}  // namespace supple::test
