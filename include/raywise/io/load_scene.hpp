// Reads scene files: OBJ, PLY, STL, glTF and GLB. Malformed input is refused, never guessed at.
#pragma once

#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <filesystem>
#include <limits>

namespace raywise {

struct LoadOptions {
    /// Drop triangles with a vertex that is not finite or beyond `max_coordinate`, and count them,
    /// instead of refusing the file.
    bool skip_invalid = false;

    /// The memory that reading may take, in bytes; more is refused before it is allocated, with
    /// ErrorKind::limit. Unlimited by default.
    std::size_t max_bytes = std::numeric_limits<std::size_t>::max();
};

/// What reading met, beside the scene.
struct LoadReport {
    std::size_t dropped = 0;    ///< invalid triangles dropped by `skip_invalid`
    std::size_t degenerate = 0; ///< triangles of zero area, loaded
    std::size_t polygons = 0;   ///< faces of more than three corners, triangulated
    std::size_t ignored = 0;    ///< points and lines, which rays cannot meet
};

/// The scene in the file. The format follows from the suffix (.obj .ply .stl .gltf .glb, any case)
/// and must agree with the content. Only regular files are opened; buffers of a glTF file only
/// within its folder. The scene passes `validate` and has at least one triangle. Throws Error with
/// the file, the place and the reason; peak memory is at most 64 MiB + 40 times the file's size.
[[nodiscard]] Scene load_scene(const std::filesystem::path& path, const LoadOptions& options = {});

/// The same; the report is overwritten.
[[nodiscard]] Scene
load_scene(const std::filesystem::path& path, const LoadOptions& options, LoadReport& report);

} // namespace raywise
