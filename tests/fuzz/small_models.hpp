#pragma once
/// \file Reduced models of a few cells, put together without any computation, and what else a small object needs.

#include <app/scene/trajectory.hpp>
#include <reduction/model/reduced_model.hpp>

#include <vector>

namespace supple::fuzz {

/// Some six tets, hexahedra, quadratic tets or flaps; the first two nodes are held. Solids have two regions.
std::vector<Body> small_bodies();
/// A random basis W ⊗ I_block, mass-orthonormal, three components, and an indicator of another one.
/// \param block  1 or 3.
ReducedModel small_model(const Body& body, int block);

/// Three frames of a model in a file, in its coordinates or of all nodes.
Trajectory small_trajectory(const std::filesystem::path& model, bool reduced);

}  // namespace supple::fuzz
