/// \file Files of some hundred bytes that announce 10¹² things are refused before anything is allocated for these.

#include <core/output_file.hpp>
#include <tests/fuzz/fuzz_target.hpp>
#include <tests/io/damage.hpp>
#include <tests/support/test_folder.hpp>

#include <gtest/gtest.h>
#include <zlib.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <sys/resource.h>
#include <unistd.h>

namespace supple::fuzz {

namespace {

struct Claim {
  std::string target, bytes;
};

template <typename... Numbers>
std::string raw(Numbers... numbers) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&numbers), sizeof numbers), ...);
  return bytes;
}

/// One black pixel, said to be 30 000 × 30 000 of them.
std::string large_picture() {
  const auto big = [](std::uint32_t value) {
    std::string bytes = raw(value);
    std::reverse(bytes.begin(), bytes.end());
    return bytes;
  };
  const auto chunk = [&](const std::string& content) {  // with its name
    const auto crc = ::crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size()));
    return big(static_cast<std::uint32_t>(content.size() - 4)) + content + big(static_cast<std::uint32_t>(crc));
  };
  const std::string line("\0\0", 2);
  uLongf size = 100;
  std::string packed(size, '\0');
  ::compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(line.data()), line.size());
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR" + big(30000) + big(30000) + std::string("\1\0\0\0\0", 5)) +
         chunk("IDAT" + packed.substr(0, size)) + chunk("IEND");
}

std::vector<Claim> claims() {
  constexpr std::uint64_t many = 1'000'000'000'000;
  const std::string n = std::to_string(many), gmsh = "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
                    gmsh_binary = "$MeshFormat\n2.2 1 8\n" + raw(std::int32_t{1}) + "\n$EndMeshFormat\n",
                    gmsh_4 = "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", three = "1 0 0 0\n2 1 0 0\n3 0 1 0\n",
                    gmsh_nodes = "$Nodes\n3\n" + three + "$EndNodes\n", vtk = "# vtk DataFile Version 3.0\nt\n",
                    grid = "\nDATASET UNSTRUCTURED_GRID\nPOINTS ",
                    xml = "<VTKFile type=\"UnstructuredGrid\" header_type=\"UInt64\"";
  const auto vtu = [&](const std::string& points, const std::string& appended, const std::string& attribute = "") {
    return xml + attribute + "><UnstructuredGrid><Piece NumberOfPoints=\"" + points +
           "\" NumberOfCells=\"1\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"3\" format=\"appended\" "
           "offset=\"0\"/></Points></Piece></UnstructuredGrid><AppendedData encoding=\"raw\">_" +
           appended + "</AppendedData></VTKFile>";
  };
  const std::string zlib = " compressor=\"vtkZLibDataCompressor\"";
  const std::string ply = "ply\nformat ascii 1.0\nelement vertex ",
                    xyz = "\nproperty float x\nproperty float y\nproperty float z\n",
                    ply_binary = "ply\nformat binary_little_endian 1.0\nelement vertex ",
                    faces = "property list uint int vertex_indices\nend_header\n";
  std::string npy = "{'descr': '<f8', 'fortran_order': False, 'shape': (" + n + ", 3), }";
  npy.resize(117, ' ');
  return {{"gmsh", gmsh + "$Nodes\n" + n + "\n" + three},
          {"gmsh", gmsh + gmsh_nodes + "$Elements\n" + n + "\n1 4 2 1 1 1 2 3 4\n"},
          {"gmsh", gmsh + "$PhysicalNames\n" + n + "\n3 1 \"a\"\n"},
          {"gmsh", gmsh_binary + "$Nodes\n" + n + "\n" + raw(std::int32_t{1}, 0.0, 0.0, 0.0)},
          {"gmsh", gmsh_binary + "$Nodes\n1\n" + raw(std::int32_t{1}, 0.0, 0.0, 0.0) + "\n$EndNodes\n$Elements\n" + n +
                       "\n" + raw(4, INT32_MAX, 2, 1, 1)},
          {"gmsh", gmsh_4 + "$Entities\n" + n + " 0 0 " + n + "\n"},
          {"gmsh", gmsh_4 + "$Nodes\n1 " + n + " 1 " + n + "\n3 1 0 " + n + "\n1\n0 0 0\n"},
          {"gmsh", gmsh_4 + "$Nodes\n1 1 1 1\n3 1 0 1\n1\n0 0 0\n$EndNodes\n$Elements\n1 " + n + " 1 1\n3 1 4 " + n +
                       "\n1 1 1 1 1\n"},
          {"tetgen", n + " 3 0 0\n" + three + "\f1 4 0\n1 1 2 3 4\n"},
          {"tetgen", "3 3 0 0\n" + three + "\f" + n + " 4 0\n1 1 2 3 3\n"},
          {"medit", "MeshVersionFormatted 2\nDimension 3\nVertices\n" + n + "\n0 0 0 0\n"},
          {"medit", "MeshVersionFormatted 2\nDimension 3\nVertices\n1\n0 0 0 0\nTetrahedra\n" + n + "\n1 1 1 1 0\n"},
          {"vega", "*VERTICES\n" + n + " 3 0 0\n" + three},
          {"vega", "*VERTICES\n3 3 0 0\n" + three + "*ELEMENTS\nTET\n" + n + " 4 0\n1 1 2 3 3\n"},
          {"vtk", vtk + "ASCII" + grid + n + " double\n0 0 0\n"},
          {"vtk", vtk + "BINARY" + grid + n + " double\n0 0 0\n"},
          {"vtk", vtk + "ASCII" + grid + "1 double\n0 0 0\nCELLS " + n + " " + n + "\n4 0 0 0 0\n"},
          {"vtk", vtk + "ASCII" + grid + "1 double\n0 0 0\nFIELD f " + n + "\na " + n + " " + n + " double\n"},
          {"vtu", vtu(n, raw(many * 24))},
          {"vtu", vtu("1", raw(many))},
          {"vtu", vtu("1", raw(many, many, many, many), zlib)},
          {"vtu", vtu("1", raw(std::uint64_t{1}, many, many, std::uint64_t{9}) + "123456789", zlib)},
          {"off", "OFF\n" + n + " 1 0\n0 0 0\n"},
          {"off", "OFF\n1 " + n + " 0\n0 0 0\n3 0 0 0\n"},
          {"off", "OFF\n1 1 0\n0 0 0\n" + n + " 0 0 0\n"},
          {"ply", ply + n + xyz + "end_header\n0 0 0\n"},
          {"ply", ply + "1" + xyz + "element face " + n + "\n" + faces + "0 0 0\n3 0 0 0\n"},
          {"ply", ply + "1" + xyz + "element face 1\n" + faces + "0 0 0\n" + n + " 0 0 0\n"},
          {"ply", ply_binary + n + xyz + "end_header\n" + raw(0.f, 0.f, 0.f)},
          {"ply", ply_binary + "1" + xyz + "element face 1\n" + faces + raw(0.f, 0.f, 0.f, UINT32_MAX, 0)},
          {"ply", ply + n + "\nelement vertex 1" + xyz + "end_header\n"},
          {"stl", std::string(80, ' ') + raw(UINT32_MAX) + std::string(50, '\0')},
          {"matrices", std::string("\x93NUMPY\1\0\x76\0", 10) + npy + "\n12345678"},
          {"matrices", std::string("\x93NUMPY\2\0\xff\xff\xff\x7f", 12) + npy},
          {"matrices", "%%MatrixMarket matrix array real general\n" + n + " " + n + "\n1\n"},
          {"matrices", "%%MatrixMarket matrix coordinate real general\n" + n + " " + n + " " + n + "\n1 1 1\n"},
          {"pictures", large_picture()},
          {"tensor_files", raw(std::uint64_t{99'999'999}) + "{}        "},
          {"tensor_files", raw(many) + "{}        "}};
}

/// While one is there, the program may take only so much more memory than it has, by whatever call.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::size_t more) {
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which map terabytes for themselves
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    ::getrlimit(RLIMIT_AS, &before_);
    if (pages == 0) return;
    const rlimit limit{pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE)) + more, before_.rlim_max};
    is_set_ = ::setrlimit(RLIMIT_AS, &limit) == 0;
#else
    (void)more;
#endif
  }
  ~MemoryLimit() {
    if (is_set_) ::setrlimit(RLIMIT_AS, &before_);
  }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit before_{};
  bool is_set_ = false;
};

TEST(Claims, OfMoreThanAFileCanHoldAreRefusedBeforeAnythingIsAllocated) {
  std::vector<Target> targets = reader_targets();
  std::ranges::move(model_targets(), std::back_inserter(targets));
  const std::filesystem::path folder = test::test_folder();
  for (const auto& [name, bytes] : claims()) {
    SCOPED_TRACE(name + ": " + testing::PrintToString(bytes));
    const auto target = std::ranges::find(targets, name, &Target::name);
    ASSERT_NE(target, targets.end());
    ASSERT_LT(bytes.size(), 600u);
    test::forget_requests();
    const MemoryLimit limit(64 << 20);
    try {
      EXPECT_EQ(target->read(bytes, folder), Answer::Refused);
    } catch (const std::exception& error) {  // std::bad_alloc, too
      ADD_FAILURE() << error.what();
    }
    EXPECT_LT(test::largest_request(), std::size_t{1} << 20);
  }
}

}  // namespace

}  // namespace supple::fuzz
