// The rays that a path tracer makes in a scene, by class, with the influence areas that they belong
// to: what `raywise bench` times.
#pragma once

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/analysis/ray_class.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace raywise {

struct WorkloadParams {
    std::uint64_t seed = 1;
    std::size_t paths = std::size_t{1} << 16U; ///< of all eyes together, in [1, 10^8]
    int emitters = 2;                          ///< eyes, suns and lamps each, in [1, 64]
    std::optional<int> up_axis = {}; ///< 0, 1 or 2; absent: the shortest side of the scene's box,
                                     ///< y and then z where it is not clear (within an eighth)
    double offset = 0x1p-16; ///< shadow and bounce rays begin this share of the scene's diagonal
                             ///< away from their surface (t_min); in [0, 1]
};

/// The rays of one emitter or eye.
struct EmitterRays {
    std::string area; ///< of Workload::areas; empty: rays of no area
    std::vector<Ray> rays;
};

struct ClassRays {
    RayClass rays = RayClass::primary;
    std::vector<EmitterRays> emitters;

    /// Of all emitters.
    [[nodiscard]] std::size_t count() const;
};

/// Areas under names that differ, one per emitter and class, and the rays of each class.
struct Workload {
    std::vector<InfluenceArea> areas;
    std::vector<ClassRays> classes; ///< in the order asked for
    double offset = 0;              ///< scene units
};

/// Rays of the asked classes as a path tracer with next-event estimation makes them. Eyes see
/// pictures of 1024 x 1024 pixels, of which a random choice of tiles (16 x 16) is traced in order;
/// every path is a primary ray, a diffuse bounce from its hit, and from both hits shadow rays to
/// the emitters in front of the surface. Shadow rays lie in the order of the paths, the one from
/// the primary hit before the one from the bounce's.
///
/// Eyes and lamps with an even number stand outside on a sphere of 0.75 scene diagonals, at least
/// 6 degrees above the horizon; those with an odd number at open places inside
/// (`find_open_place`); suns are high (50 to 80 degrees) and low (8 to 30 degrees) in turn. A lamp
/// with a shade has a radius of 1 % of the diagonal, a lens one of 0.1 %, focused on the middle of
/// the scene or, inside, a quarter of the diagonal away.
///
/// The same for any executor. Throws Error for parameters out of range, and for a scene without
/// triangles or without extent. `oracle` answers for the scene's triangles. A class may have no
/// rays: a scene that nothing hits casts no shadow rays.
[[nodiscard]] Workload make_workload(
    const Scene& scene,
    const ExactOracle& oracle,
    std::span<const RayClass> classes,
    const WorkloadParams& params = {},
    const Executor& executor = serial_executor()
);

} // namespace raywise
