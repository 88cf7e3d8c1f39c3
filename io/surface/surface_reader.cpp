#include <io/mesh/mesh_repairs.hpp>
#include <io/surface/surface_formats.hpp>
#include <io/surface/surface_reader.hpp>

#include <Eigen/Geometry>

#include <cstdio>

namespace supple {
namespace {

[[noreturn]] void refuse_unknown(const std::string& name, std::string_view bytes) {
  const std::string_view word = first_word(bytes);
  std::string found = "the format of the file is not known";
  if (bytes.empty())
    found = "the file is empty";
  else if (bytes.starts_with("\x1f\x8b"))
    found = "the file is compressed (gzip); unpack it first";
  else if (word.starts_with('$') || word.starts_with('*') || word == "MeshVersionFormatted" || word.starts_with("<") ||
           bytes.starts_with("# vtk"))
    found = "the file looks like a mesh of solids (Gmsh, Medit, VegaFEM or VTK)";
  throw InputError(name + ": " + found + "; expected a surface: OBJ, OFF, PLY or STL");
}

FileSurface read_any(const std::filesystem::path& path) {
  const std::string bytes = read_text(path), name = path.string();
  const std::string_view word = first_word(bytes);
  const auto is_word = [&](std::initializer_list<std::string_view> words) {
    return std::find(words.begin(), words.end(), word) != words.end();
  };
  FileSurface surface;
  Cursor plain(name, bytes), with_comments(name, bytes, {.separator = '\0', .comment = '#'}),
      with_continuation(name, bytes, {.separator = '\0', .comment = '#', .continuation = '\\'});
  if (word == "ply")
    read_ply(plain, surface);
  else if (is_off_keyword(word))
    read_off(with_comments, surface);
  else if (is_binary_stl(bytes) || (has_extension(path, ".stl") && word != "solid" && word != "SOLID"))
    read_binary_stl(plain, surface);
  else if (word == "solid" || word == "SOLID")
    read_ascii_stl(plain, surface);
  else if (is_word({"v", "vn", "vt", "f", "o", "g", "s", "mtllib", "usemtl"}) || has_extension(path, ".obj"))
    read_obj(with_continuation, surface);
  else
    refuse_unknown(name, bytes);
  return surface;
}

/// Twice the area of a polygon as a vector along its normal; any simple polygon, flat or nearly so.
Point area_vector(const FileSurface& surface, std::span<const Index> face) {
  Point sum = Point::Zero();
  const Point& a = surface.nodes[face[0]];
  for (std::size_t k = 1; k + 1 < face.size(); ++k)
    sum += (surface.nodes[face[k]] - a).cross(surface.nodes[face[k + 1]] - a);
  return sum;
}

/// The fan of triangles from one corner of a face. \return whether all turn as the face does.
bool cut_into_fan(const FileSurface& surface, std::span<const Index> face, std::size_t apex,
                  std::vector<Triangle>& fan) {
  const Point area = area_vector(surface, face);
  const std::size_t size = face.size();
  bool same_turn = true;
  fan.clear();
  for (std::size_t k = 1; k + 1 < size; ++k) {
    fan.push_back({face[apex], face[(apex + k) % size], face[(apex + k + 1) % size]});
    same_turn &= !(area.dot(area_vector(surface, fan.back())) <= 0);  // NaN: check_mesh has the words
  }
  return same_turn;
}

/// Triangles of all faces, and the number of the face that each comes from.
std::vector<Triangle> cut_faces(FileSurface& surface, std::vector<std::int64_t>& numbers, const std::string& name) {
  std::vector<Triangle> triangles, fan;
  Index num_polygons = 0, num_small = 0;
  for (Index f = 0; f < surface.num_faces(); ++f) {
    const std::span<const Index> face = surface.face(f);
    if (face.size() < 3) {
      ++num_small;
      continue;
    }
    if (face.size() == 3) {
      fan = {{face[0], face[1], face[2]}};
    } else {
      ++num_polygons;
      std::size_t apex = 0;
      while (apex < face.size() && !cut_into_fan(surface, face, apex, fan)) ++apex;
      if (apex == face.size())
        throw InputError(name + ": face " + std::to_string(surface.first_number + f) + " has " +
                         std::to_string(face.size()) +
                         " corners, and from none of them triangles fan out over the whole face; cut it into "
                         "triangles first");
    }
    triangles.insert(triangles.end(), fan.begin(), fan.end());
    numbers.insert(numbers.end(), fan.size(), surface.first_number + f);
  }
  if (num_polygons > 0)
    surface.warnings.push_back(plural(num_polygons, "polygon was", "polygons were") + " cut into fans of triangles");
  if (num_small > 0)
    surface.warnings.push_back(plural(num_small, "face has", "faces have") + " fewer than three corners: left out");
  if (surface.num_lower > 0)
    surface.warnings.push_back(plural(surface.num_lower, "line or point", "lines and points") + " left out");
  return triangles;
}

void warn_of_surprises(const TriangleMesh& mesh, const MeshNumbers& numbers, std::vector<std::string>& warnings) {
  if (const Index count = num_coincident_nodes(mesh.nodes); count > 0)
    warnings.push_back(plural(count, "node lies", "nodes lie") + " where another node is: not merged");
  if (const Index count = connected_components(mesh).count; count > 1)
    warnings.push_back(std::to_string(count) + " components that are not connected");
  if (const Index count = surface_hinges(mesh.triangles, mesh.num_nodes()).nodes; count > 0)
    warnings.push_back("parts hang together by " + plural(count, "node", "nodes") +
                       " only, about which they turn freely");
  double worst = 1;
  Index at = 0;
  for (Index t = 0; t < mesh.num_triangles(); ++t)
    if (const double ratio = radius_ratio(mesh, t); ratio < worst) worst = ratio, at = t;
  if (worst < 1e-3) {
    std::array<char, 32> shown;
    std::snprintf(shown.data(), shown.size(), "%.2g", worst);
    warnings.push_back("needles: the worst, triangle " + std::to_string(numbers.triangle[at]) + ", has radius ratio " +
                       shown.data());
  }
}

}  // namespace

TriangleMesh read_triangle_mesh(const std::filesystem::path& path, MeshNotes* notes) {
  FileSurface file = read_any(path);
  const std::string name = path.string();
  MeshNumbers numbers;
  TriangleMesh mesh;
  mesh.triangles = cut_faces(file, numbers.triangle, name);
  if (mesh.triangles.empty()) throw InputError(name + ": holds no triangles");
  numbers.node.resize(file.nodes.size());
  std::iota(numbers.node.begin(), numbers.node.end(), file.first_number);
  mesh.nodes = keep_nodes_in_use(file.nodes, mesh.triangles, numbers.node, mesh.places);
  if (const Index dropped = static_cast<Index>(file.nodes.size()) - mesh.num_nodes(); dropped > 0)
    file.warnings.push_back(plural(dropped, "node belongs", "nodes belong") + " to no triangle: dropped");
  try {
    if (const Index turned = orient_consistently(mesh, numbers); turned > 0)
      file.warnings.push_back(plural(turned, "triangle was", "triangles were") +
                              " turned over against the others: turned back");
    check_mesh(mesh, numbers);
  } catch (const std::invalid_argument& error) {
    throw InputError(name + ": " + error.what() + " (" + file.numbering + ")");
  }
  if (notes) {
    warn_of_surprises(mesh, numbers, file.warnings);
    *notes = {std::move(file.format), std::move(file.warnings), std::move(numbers)};
  }
  return mesh;
}

}  // namespace supple
