#pragma once
/// \file Edit scenes as JSON, read and written; see docs/edit-scene.md.

#include <io/text/json_fields.hpp>
#include <physics/body/body.hpp>
#include <reduction/editing/edit_scene.hpp>

#include <nlohmann/json_fwd.hpp>

#include <filesystem>
#include <string>
#include <vector>

namespace supple {

/// The scene of a file. \throws InputError naming file, place and what was expected there; unknown keys are refused.
/// \param warnings  of what is probably not meant, such as an angle of 30 radians; null: not wanted.
EditScene read_edit_scene(const std::filesystem::path& path, const Body& body,
                          std::vector<std::string>* warnings = nullptr);
/// The scene of an object inside another document, which may name no files: from a client, nobody's are read.
/// Whoever reads the document calls finish(). \throws InputError as above.
EditScene read_edit_scene(const JsonFields& scene, const Body& body);

/// What read_edit_scene() makes the same scene of, but for outside forces; handles list their nodes.
nlohmann::ordered_json edit_scene_json(const EditScene& scene, const NodePlaces& places);

}  // namespace supple
