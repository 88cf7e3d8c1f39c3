#include <tests/io/file_bytes.hpp>
#include <tests/io/surface_files.hpp>

#include <array>

namespace supple::test {
namespace {

std::string obj(const TriangleMesh& mesh) {
  std::string s = "# a comment\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += "v " + xyz(mesh, v) + "\n";
  for (const Triangle& t : mesh.triangles)
    s += "f " + std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1) + "\n";
  return s;
}

/// With everything that an OBJ may hold besides: all forms of corners, indices from the end, CRLF.
std::string obj_rich(const TriangleMesh& mesh) {
  std::string s = "mtllib none.mtl\r\no thing # its name\r\n\r\nvt 0 0\r\nvn 0 0 1\r\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += "v\t" + xyz(mesh, v) + " 1.0\r\n";
  s += "g part\r\nusemtl red\r\ns off\r\n";
  const std::array<std::string, 4> tails{"", "/1", "/1/1", "//1"};
  for (Index t = 0; t < mesh.num_triangles(); ++t) {
    s += "f";
    for (int k = 0; k < 3; ++k) {
      const Index v = mesh.triangles[t][k];
      s += " " + std::to_string(t % 3 == 2 ? v - mesh.num_nodes() : v + 1) + tails[t % 4];
      if (t % 5 == 4 && k == 1) s += " \\\r\n";
    }
    s += "\r\n";
  }
  return s;
}

std::string off(const TriangleMesh& mesh) {
  std::string s = "OFF\n" + std::to_string(mesh.num_nodes()) + " " + std::to_string(mesh.num_triangles()) + " 0\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += xyz(mesh, v) + "\n";
  for (const Triangle& t : mesh.triangles)
    s += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
  return s;
}

std::string off_rich(const TriangleMesh& mesh) {
  std::string s = "# first\nCNOFF " + std::to_string(mesh.num_nodes()) + " " + std::to_string(mesh.num_triangles()) +
                  "\n\n# second\n";
  for (Index v = 0; v < mesh.num_nodes(); ++v) s += xyz(mesh, v) + "  0 0 1  0.5 0.5 0.5 1 # third\n\n";
  for (const Triangle& t : mesh.triangles)
    s += " 3\t" + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "  255 0 0\n";
  return s;
}

struct PlyStyle {
  bool binary, big_endian, rich;
  bool float_coordinates = false;
};

std::string ply(const TriangleMesh& mesh, const PlyStyle& style) {
  std::string s = std::string("ply\nformat ") +
                  (!style.binary      ? "ascii"
                   : style.big_endian ? "binary_big_endian"
                                      : "binary_little_endian") +
                  " 1.0\ncomment made by a test\n";
  const std::string real = style.float_coordinates ? "float" : "float64";
  if (style.rich) s += "obj_info none\nelement camera 2\nproperty float fov\nproperty list uchar short ids\n";
  s += "element vertex " + std::to_string(mesh.num_nodes()) + "\n";
  if (style.rich) s += "property uchar red\n";
  s += "property " + real + " x\nproperty " + real + " y\n";
  if (style.rich) s += "property list uint8 float weights\n";
  s += "property " + real + " z\nelement face " + std::to_string(mesh.num_triangles()) + "\n";
  if (style.rich) s += "property int group\n";
  s += style.rich ? "property list ushort uint32 vertex_index\nproperty double area\n"
                  : "property list uchar int vertex_indices\n";
  if (style.rich) s += "element empty 7\nelement edge 1\nproperty int v\n";
  s += "end_header\n";
  const auto put = [&]<typename Number>(Number value) {
    if (style.binary)
      s += raw(value, style.big_endian);
    else if constexpr (std::is_integral_v<Number>)
      s += std::to_string(value) + " ";
    else
      s += text(value) + " ";
  };
  const auto coordinate = [&](double x) {
    if (style.float_coordinates)
      put(static_cast<float>(x));
    else
      put(x);
  };
  if (style.rich)
    for (std::int16_t k = 0; k < 2; ++k) {
      put(0.5f), put(std::uint8_t{2}), put(k), put(std::int16_t{-3});
    }
  for (Index v = 0; v < mesh.num_nodes(); ++v) {
    if (style.rich) put(std::uint8_t{200});
    coordinate(mesh.nodes(v, 0)), coordinate(mesh.nodes(v, 1));
    if (style.rich) put(std::uint8_t{1}), put(0.25f);
    coordinate(mesh.nodes(v, 2));
    if (!style.binary) s += "\n";
  }
  for (const Triangle& t : mesh.triangles) {
    if (style.rich) put(std::int32_t{-7});
    if (style.rich)
      put(std::uint16_t{3});
    else
      put(std::uint8_t{3});
    for (const Index v : t)
      if (style.rich)
        put(static_cast<std::uint32_t>(v));
      else
        put(static_cast<std::int32_t>(v));
    if (style.rich) put(1.5);
    if (!style.binary) s += "\n";
  }
  if (style.rich) put(std::int32_t{1});
  return s;
}

std::string stl_ascii(const TriangleMesh& mesh) {
  std::string s = "solid a name of several words\n";
  for (const Triangle& t : mesh.triangles) {
    s += " facet normal 0 0 nan\n  outer loop\n";
    for (const Index v : t) s += "   vertex " + xyz(mesh, v) + "\n";
    s += "  endloop\n endfacet\n";
  }
  return s + "endsolid a name of several words\n";
}

std::string stl_binary(const TriangleMesh& mesh) {
  std::string s = "solid, which a binary file should not begin with";
  s.resize(80, ' ');
  s += raw(static_cast<std::uint32_t>(mesh.num_triangles()));
  for (const Triangle& t : mesh.triangles) {
    for (int c = 0; c < 3; ++c) s += raw(0.0f);
    for (const Index v : t)
      for (int c = 0; c < 3; ++c) s += raw(static_cast<float>(mesh.nodes(v, c)));
    s += raw(std::uint16_t{0});
  }
  return s;
}

}  // namespace

std::vector<MeshFile> in_every_format(const TriangleMesh& mesh) {
  std::vector<MeshFile> files{{"obj", ".obj", obj(mesh), ""},
                              {"obj_rich", ".obj", obj_rich(mesh), ""},
                              {"off", ".off", off(mesh), ""},
                              {"off_rich", ".off", off_rich(mesh), ""},
                              {"stl_ascii", ".stl", stl_ascii(mesh), ""},
                              {"stl_binary_float", ".stl", stl_binary(mesh), ""}};
  for (const bool rich : {false, true})
    for (const auto& [name, binary, big] :
         {std::tuple{"ply_ascii", false, false}, {"ply_little_endian", true, false}, {"ply_big_endian", true, true}})
      files.push_back({name + std::string(rich ? "_rich" : ""), ".ply",
                       ply(mesh, {.binary = binary, .big_endian = big, .rich = rich}), ""});
  files.push_back({"ply_float", ".ply",
                   ply(mesh, {.binary = true, .big_endian = false, .rich = false, .float_coordinates = true}), ""});
  return files;
}

}  // namespace supple::test
