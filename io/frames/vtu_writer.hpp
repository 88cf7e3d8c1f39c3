#pragma once
/// \file Writer of meshes with fields, single or in time, for ParaView and every other reader of VTK's XML files.

#include <physics/mesh/tet_mesh.hpp>

#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace supple {

/// A quantity at every node or in every cell, one row each: 1 column for a scalar, 3 for a vector.
struct VtuField {
  std::string name;  ///< with the unit, as "displacement [m]"
  RowMatrix values;
};

/// The field of an interleaved vector x₀ y₀ z₀ x₁ …: n × 3.
VtuField vector_field(std::string name, VectorIn u);

struct VtuFields {
  std::vector<VtuField> point_data = {};
  std::vector<VtuField> cell_data = {};
};

/// Writes an UnstructuredGrid of tetrahedra, hexahedra, quadratic tetrahedra or triangles, arrays in raw binary after the
/// XML; positions in m.
/// \throws std::invalid_argument if a field has not one row a node or cell, two fields of one kind have the
/// same name or a cell reads a node that is not there; InputError if the file cannot be written.
/// \see VTK File Formats, "XML File Formats", Kitware.
void write_vtu(const std::filesystem::path& path, const Points& nodes, std::span<const Tet> tets,
               const VtuFields& fields = {});
void write_vtu(const std::filesystem::path& path, const Points& nodes, std::span<const std::array<Index, 8>> hexahedra,
               const VtuFields& fields = {});
void write_vtu(const std::filesystem::path& path, const Points& nodes,
               std::span<const std::array<Index, 10>> quadratic_tets, const VtuFields& fields = {});
void write_vtu(const std::filesystem::path& path, const Points& nodes, std::span<const Triangle> triangles,
               const VtuFields& fields = {});

/// A time series: `<name>.pvd` lists `<name>_000000.vtu`, … with their times. The list is replaced in one
/// step after each frame, so it is complete at every moment; an interrupted run leaves a series of what it
/// finished.
class VtuSeries {
 public:
  /// Starts an empty series. \throws InputError if the path does not end in .pvd or cannot be written.
  explicit VtuSeries(std::filesystem::path pvd);

  /// Writes one more frame.
  /// \throws std::invalid_argument if time [s] is not after the last one; as write_vtu.
  void add(double time, const Points& nodes, std::span<const Tet> tets, const VtuFields& fields = {});
  void add(double time, const Points& nodes, std::span<const std::array<Index, 8>> hexahedra,
           const VtuFields& fields = {});
  void add(double time, const Points& nodes, std::span<const std::array<Index, 10>> quadratic_tets,
           const VtuFields& fields = {});
  void add(double time, const Points& nodes, std::span<const Triangle> triangles, const VtuFields& fields = {});

  Index num_frames() const { return static_cast<Index>(frames_.size()); }

 private:
  template <typename Cell>
  void add_frame(double time, const Points& nodes, std::span<const Cell> cells, const VtuFields& fields);
  void write_list() const;

  std::filesystem::path pvd_;
  std::vector<std::pair<double, std::string>> frames_;  // time and name of the file
};

}  // namespace supple
