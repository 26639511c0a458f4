// The rays of an influence area as a picture: one ray per pixel, over the area's own window.
#pragma once

#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>

#include <optional>
#include <vector>

namespace raywise::app {

/// Rays in rows from the top of the window, each row from its left.
struct AreaView {
    int width = 0;
    int height = 0;
    std::vector<Ray> rays; ///< width * height of them
};

/// The view of an area with about `pixels` >= 1 square pixels. Parallel areas: the window, seen
/// along the rays. Radial areas: the window as a pinhole camera at the eye sees it, or a panorama
/// of all directions (azimuth to the right, elevation up). Nothing for uniform and measured areas:
/// they have no window.
[[nodiscard]] std::optional<AreaView> view_of(const InfluenceArea& area, int pixels);

} // namespace raywise::app
