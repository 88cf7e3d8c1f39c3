#include <core/check.hpp>
#include <io/frames/vtu_writer.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <unistd.h>

namespace supple {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

std::string read_all(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

struct VtuWriter : testing::Test {
  VtuWriter() {
    fs::create_directories(folder);
    nodes << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 0.1;
  }
  ~VtuWriter() override { fs::remove_all(folder); }

  VtuFields fields() const {
    return {.point_data = {vector_field("displacement [m]", Vector::LinSpaced(15, 0, 14)),
                           {"heat <&\">", RowMatrix::Constant(5, 1, 0.5)}},
            .cell_data = {{"weight", RowMatrix::NullaryExpr(2, 1, [](Index e, Index) { return e + 1.25; })}}};
  }

  /// The array of this name as raw numbers, found by the rules of the format.
  template <typename T>
  static std::vector<T> array(const std::string& file, const std::string& name) {
    const std::size_t tag = file.find("Name=\"" + name + "\"");
    EXPECT_NE(tag, file.npos) << name;
    const std::size_t offset = std::stoul(file.substr(file.find("offset=\"", tag) + 8));
    const std::size_t block = file.find('_', file.find("<AppendedData")) + 1 + offset;
    std::uint64_t bytes;
    std::memcpy(&bytes, file.data() + block, 8);
    std::vector<T> values(bytes / sizeof(T));
    if (bytes > 0) std::memcpy(values.data(), file.data() + block + 8, bytes);
    return values;
  }

  const fs::path folder = fs::temp_directory_path() / ("supple-vtu-" + std::to_string(::getpid()));
  const fs::path path = folder / "mesh.vtu";
  Points nodes{5, 3};
  const std::vector<Tet> tets{{0, 1, 2, 3}, {1, 4, 2, 3}};
};

TEST_F(VtuWriter, ArraysStandWhereTheXmlSays) {
  write_vtu(path, nodes, tets, fields());
  const std::string file = read_all(path);
  EXPECT_EQ(array<double>(file, "Points"), std::vector<double>(nodes.data(), nodes.data() + 15));
  EXPECT_THAT(array<std::int64_t>(file, "connectivity"), testing::ElementsAre(0, 1, 2, 3, 1, 4, 2, 3));
  EXPECT_THAT(array<std::int64_t>(file, "offsets"), testing::ElementsAre(4, 8));
  EXPECT_THAT(array<std::uint8_t>(file, "types"), testing::ElementsAre(10, 10));
  EXPECT_THAT(array<double>(file, "weight"), testing::ElementsAre(1.25, 2.25));
  EXPECT_EQ(array<double>(file, "displacement [m]")[14], 14);
  EXPECT_THAT(file, HasSubstr("Name=\"heat &lt;&amp;&quot;&gt;\" NumberOfComponents=\"1\""));
  EXPECT_THAT(file, AllOf(HasSubstr("NumberOfPoints=\"5\" NumberOfCells=\"2\""), HasSubstr("header_type=\"UInt64\"")));
}

TEST_F(VtuWriter, MeshioReadsTetsTrianglesAndFields) {
  if (std::system("/usr/bin/python3 -c 'import meshio' 2>/dev/null") != 0)
    GTEST_SKIP() << "python3-meshio is not installed";
  write_vtu(path, nodes, tets, fields());
  const std::vector<Triangle> triangles{{0, 1, 2}, {1, 4, 2}};
  write_vtu(folder / "surface.vtu", nodes, triangles, fields());
  const std::string script =
      "import meshio, numpy as np\n"
      "for name, kind, k in (('mesh.vtu', 'tetra', 4), ('surface.vtu', 'triangle', 3)):\n"
      "    mesh = meshio.read('" +
      folder.string() +
      "/' + name)\n"
      "    assert mesh.points.shape == (5, 3) and mesh.points[4, 2] == 0.1\n"
      "    assert mesh.cells[0].type == kind and mesh.cells[0].data.shape == (2, k)\n"
      "    assert mesh.cells[0].data[1].tolist() == [1, 4, 2, 3][:k]\n"
      "    u = mesh.point_data['displacement [m]']\n"
      "    assert u.shape == (5, 3) and np.array_equal(u.ravel(), np.arange(15.0))\n"
      "    assert np.all(mesh.point_data['heat <&\">'] == 0.5)\n"
      "    assert mesh.cell_data['weight'][0].ravel().tolist() == [1.25, 2.25]\n";
  std::ofstream(folder / "check.py") << script;
  EXPECT_EQ(std::system(("/usr/bin/python3 '" + (folder / "check.py").string() + "'").c_str()), 0);
}

TEST_F(VtuWriter, EmptyMeshesAreWritten) {
  write_vtu(path, Points(0, 3), std::span<const Tet>());
  EXPECT_TRUE(array<double>(read_all(path), "Points").empty());
}

TEST_F(VtuWriter, RefusesFieldsAndCellsThatDoNotFit) {
  const auto refuse = [&](const VtuFields& wrong, const std::string& reason) {
    EXPECT_THAT([&] { write_vtu(path, nodes, tets, wrong); }, ThrowsMessage<std::invalid_argument>(HasSubstr(reason)));
  };
  refuse({.point_data = {{"u", RowMatrix(4, 3)}}}, "field 'u' has size 4, expected 5");
  refuse({.cell_data = {{"w", RowMatrix(5, 1)}}}, "field 'w' has size 5, expected 2");
  refuse({.cell_data = {{"w", RowMatrix(2, 0)}}}, "field 'w' has no columns");
  refuse({.cell_data = {{"w", RowMatrix(2, 1)}, {"w", RowMatrix(2, 1)}}}, "two fields have the name 'w'");
  const std::vector<Tet> wrong{{0, 1, 2, 5}};
  EXPECT_THAT([&] { write_vtu(path, nodes, wrong); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("reads node 5, expected 0 to 4")));
  EXPECT_THROW(vector_field("u", Vector(4)), std::invalid_argument);
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST_F(VtuWriter, SeriesIsCompleteAfterEveryFrame) {
  const fs::path pvd = folder / "run & more.pvd";
  VtuSeries series(pvd);
  EXPECT_THAT(read_all(pvd), HasSubstr("<Collection>\n  </Collection>\n</VTKFile>"));
  for (int frame = 0; frame < 3; ++frame) {
    series.add(0.1 * frame, nodes, tets, fields());
    const std::string list = read_all(pvd);
    EXPECT_THAT(list, HasSubstr("file=\"run &amp; more_00000" + std::to_string(frame) +
                                ".vtu\"/>\n  </Collection>\n</VTKFile>"));
    EXPECT_TRUE(fs::exists(folder / ("run & more_00000" + std::to_string(frame) + ".vtu")));
  }
  EXPECT_THAT(read_all(pvd),
              AllOf(HasSubstr("timestep=\"0\""), HasSubstr("timestep=\"0.1\""), HasSubstr("timestep=\"0.2\"")));
  EXPECT_EQ(series.num_frames(), 3);
  EXPECT_THROW(series.add(0.1, nodes, tets), std::invalid_argument);
  EXPECT_THROW(VtuSeries(folder / "run.vtu"), InputError);
}

}  // namespace
}  // namespace supple
