#pragma once
/// \file Options that several commands have, declared once: same spelling, same help.

#include <core/types.hpp>

#include <filesystem>
#include <string>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace supple {

struct ProblemOptions;

/// Where the help lists what the object is: its material, what holds it.
constexpr auto object_group = "Object";
/// Where the help lists how a model comes about: the subspace, the training, the selection.
constexpr auto method_group = "Method";

CLI::Option& declare_json(CLI::App& command, std::filesystem::path& json);
void declare_threads(CLI::App& command, int& threads);
void declare_seed(CLI::App& command, std::uint64_t& seed);
/// Plug-ins are loaded while the line is read, before anything asks for what they add.
void declare_plugins(CLI::App& command);

/// The object, for all commands that begin with a mesh.
void declare_object(CLI::App& command, ProblemOptions& problem);
void declare_snapshots(CLI::App& command, ProblemOptions& problem);
/// The object and the size of its subspace.
void declare_problem(CLI::App& command, ProblemOptions& problem);
/// The training, for commands that fit forces.
void declare_fitting(CLI::App& command, ProblemOptions& problem);
/// The subspace and the training.
void declare_training(CLI::App& command, ProblemOptions& problem);
/// \throws InputError for options of meshes that stand beside a model.
void refuse_options_of_meshes(const CLI::App& command);
/// Where stages are kept.
void declare_checkpoint(CLI::App& command, ProblemOptions& problem);
/// How models are compared with the full object. \param least  number of loads.
void declare_full_loads(CLI::App& command, ProblemOptions& problem, Index least);

/// Sections of the help: what there is by name, with options.
std::string material_help();
std::string subspace_help();
std::string selector_help();

}  // namespace supple
