// What the courtyard is assembled from.
#pragma once

#include "scene/courtyard/plan.hpp"
#include "scene/mesh_builder.hpp"

#include <raywise/geometry/vec.hpp>

#include <cstdint>

namespace raywise::courtyard {

/// The ground, and stones on it that settled unevenly.
void add_pavement(MeshBuilder& mesh, const Counts& counts, std::uint64_t seed);

/// In the middle: a basin, a stem with a bowl, rippled water.
void add_fountain(MeshBuilder& mesh, const Counts& counts);

/// In a pot: a trunk and a ball of leaves.
void add_tree(MeshBuilder& mesh, Vec3d foot, const Counts& counts, std::uint64_t seed);

/// Two storeys of columns and arches before a gallery, the upper one with balustrades.
void add_arcade(MeshBuilder& mesh, const Side& side, const Counts& counts);

/// The wall behind the gallery: a face, courses of stones in running bond, doors and windows.
void add_outer_wall(MeshBuilder& mesh, const Side& side, const Counts& counts, std::uint64_t seed);

/// Half-round tiles in rows on a plane that falls from the outer wall to the court. Neighboring
/// sides meet along the hips: rows end where they do.
void add_roof(MeshBuilder& mesh, const Side& side, const Counts& counts);

} // namespace raywise::courtyard
