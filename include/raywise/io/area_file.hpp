// Influence areas in JSON files (docs/cli.md shows one of each kind).
#pragma once

#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/aabb.hpp>

#include <filesystem>
#include <vector>

namespace raywise {

/// The version of the layout, the key `schema_version` of the file.
inline constexpr int area_file_schema_version = 1;

/// The areas in the file, in its order. `scene_bounds` is the box of the scene that they are for:
/// an area without a region gets one around it, and unseen boxes of recorded rays are weighed by
/// it. Files of recorded rays must lie in the folder of the area file. Throws Error, naming the
/// file and the area, for text that is not JSON, an unknown key (with the nearest known one), a key
/// that is missing, stands twice or has the wrong type, a name that repeats, and whatever the
/// makers of InfluenceArea refuse.
[[nodiscard]] std::vector<InfluenceArea>
load_areas(const std::filesystem::path& path, const Aabb& scene_bounds);

} // namespace raywise
