// Writes scene files: binary PLY, OBJ, binary STL and GLB.
#pragma once

#include <raywise/scene/scene.hpp>

#include <filesystem>

namespace raywise {

/// Writes the scene to the file, in the format of its suffix (.ply .obj .stl .glb, any case), in
/// one step: the file is whole or not there. OBJ keeps groups; GLB keeps groups, lights and
/// cameras; PLY and STL keep triangles only. Positions and triangle order come back bit for bit (-0
/// included) except that STL merges equal vertices. Throws Error: the suffix is not known, the
/// scene is not valid or has no triangles, or the file cannot be written.
void save_scene(const std::filesystem::path& path, const Scene& scene);

} // namespace raywise
