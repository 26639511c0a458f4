// Trees in files (.rwtree): magic, version, byte order, a table of sections, a checksum for each.
#pragma once

#include <raywise/bvh/bvh.hpp>

#include <cstddef>
#include <cstdint>
#include <filesystem>

namespace raywise {

/// A tree and the scene it was built for.
struct TreeFile {
    Bvh tree;
    std::uint64_t scene_hash = 0; ///< `content_hash` of the scene
    std::size_t prim_count = 0;   ///< the scene's triangles; every id in the tree is below
};

/// Writes the tree in one step. The bytes are a function of the arguments alone. Throws Error when
/// the tree is not valid for prim_count primitives, or the file cannot be written.
void save_tree(const std::filesystem::path& path, const TreeFile& content);

/// Reads a tree back: checksums first, then the structure (every link, slot and box, the depth).
/// Any flipped bit and any cut is refused. Throws Error with the byte and the reason. Whether the
/// boxes enclose a scene's triangles is for `validate(tree, boxes)` to say.
[[nodiscard]] TreeFile load_tree(const std::filesystem::path& path);

} // namespace raywise
