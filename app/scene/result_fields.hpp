#pragma once
/// \file What ParaView gets of a state: stress and the like, with their units.

#include <io/frames/vtu_writer.hpp>
#include <physics/body/cell_stress.hpp>

#include <filesystem>
#include <vector>

namespace supple {

/// Where nodes stand in the user's file, if it is not where they stand here.
void add_places(VtuFields& fields, const NodePlaces& places, const std::vector<Index>& nodes);
/// 0 … count − 1.
std::vector<Index> all_nodes(Index count);

/// Writes a file of an object's cells, or of a shell's triangles. \param fields  to which the places of nodes are added.
void write_body(const std::filesystem::path& path, const Body& body, const Points& positions, VtuFields fields);

/// Stress, strain and energy density of every cell.
void add_stress(VtuFields& fields, const CellStress& stress);

}  // namespace supple
