// Influence areas out of what a scene says about its rays: its lights and its cameras.
#pragma once

#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <cstdint>
#include <vector>

namespace raywise {

struct ProposeParams {
    Vec3d up{0, 1, 0};      ///< of the default set; any nonzero length, finite
    std::uint64_t seed = 1; ///< of the search for a place for the default lamp
    /// Regions around the scene are wider than it by this share of its diagonal, so that points on
    /// its border are inside; in [0, 1].
    double margin = 1e-3;
};

/// One area per light and camera, in their order, lights first:
/// - directional light: parallel, in a box around the scene along its direction;
/// - point light: radial and isotropic, in the scene's box within the light's range;
/// - spot light: radial and isotropic, in the frustum around its cone, up to its range or the
///   scene's far end (as a point light beyond a half angle of 75 degrees);
/// - perspective camera: radial, pinhole, in its frustum up to the scene's far end;
/// - orthographic camera: parallel, in the box in front of its window.
/// Lights and cameras that cannot reach the scene are left out. A scene without any gets a default
/// set: "sun" (parallel, from above at an angle), "lamp" (isotropic, at the place farthest from the
/// triangles among 64 random ones in the middle of the scene's box) and "camera" (pinhole, 60
/// degrees, outside, looking at the middle). A scene without triangles has no areas.
///
/// Names are those of lights and cameras, "light" and "camera" where they have none, numbered where
/// they repeat ("sun", "sun 2"). Eyes are rounded to float, as ray origins are. Deterministic.
/// Throws Error for parameters out of range. O(triangles).
[[nodiscard]] std::vector<InfluenceArea>
propose_areas(const Scene& scene, const ProposeParams& params = {});

} // namespace raywise
