// Pictures of a comparison: what tracing each ray of an area's window costs, pair by pair.
#pragma once

#include <raywise/analysis/comparison.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/progress.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/io/image.hpp>
#include <raywise/scene/scene.hpp>

#include <span>
#include <string>
#include <vector>

namespace raywise::app {

/// A picture and the name of its file, without folder and suffix.
struct NamedImage {
    std::string name;
    Image image;
};

/// For every area with a window: one contact sheet of all pairs (AREA) and one picture per pair
/// (AREA-PAIR). A pixel is the ordered cost of its ray, in box tests, in the area's local tree; all
/// pictures of an area share one scale.
[[nodiscard]] std::vector<NamedImage> draw_heat_maps(
    const Scene& scene,
    std::span<const InfluenceArea> areas,
    const CompareParams& params,
    const Executor& executor,
    const Progress& progress
);

/// Writes the pictures into `folder`, which is made if it is not there.
void write_images(const std::string& folder, std::span<const NamedImage> images);

} // namespace raywise::app
