// Influence areas in JSON files (docs/file_formats.md tells every key).
#pragma once

#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/aabb.hpp>

#include <filesystem>
#include <span>
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

/// Writes the areas in one step, every number of regions and distributions given in full, so that
/// reading derives nothing and gives the same areas. The rays of a measured area go to a file of
/// their own beside it, STEM.INDEX.npz, INDEX from 0. Throws Error when a file cannot be written or
/// a name is not UTF-8.
void save_areas(const std::filesystem::path& path, std::span<const InfluenceArea> areas);

} // namespace raywise
