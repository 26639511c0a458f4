// Influence areas: a convex region of space and the ray distribution that holds inside it.
// [Falcone24]
#pragma once

#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>

#include <optional>
#include <string>
#include <vector>

namespace raywise {

/// How far a ray may stray from a distribution and still count as its own. Decides speed, never
/// answers.
struct Affinity {
    double angle_deg = 8.11; ///< between the ray and the distribution's line, whichever way the ray
                             ///< runs; in [0, 90]
    std::optional<double> distance = {
    }; ///< radial areas only: affine instead when the ray's line
       ///< passes within this of the eye; scene units, >= 0, finite
};

/// What InfluenceArea::parallel takes: the window is the region's shadow along the direction.
struct ParallelArea {
    Vec3d direction;                ///< of the light, or against it; any nonzero length, finite
    Region region;                  ///< with a shadow of positive area
    double cone_half_angle_deg = 0; ///< see ParallelParams
    double density = 1;             ///< relative weight, > 0, finite
    Affinity affinity{};
};

/// What InfluenceArea::radial takes: the window is the region as seen from the apex.
struct RadialArea {
    Vec3d apex;                              ///< finite
    Region region;                           ///< around the apex, or anywhere else
    Emission emission = Emission::isotropic; ///< pinhole and yaw_pitch need a region in front of
                                             ///< the apex: within some half space through it
    double radius = 0;                       ///< see RadialParams
    double density = 1;                      ///< relative weight, > 0, finite
    Affinity affinity{};
};

/// The plane form of [Falcone24]: an oriented box behind a rectangle.
struct PlaneArea {
    Vec3d point = {};       ///< center of the rectangle, finite
    Vec3d normal;           ///< the rays' direction, any nonzero length
    double half_width = 1;  ///< scene units, > 0
    double half_height = 1; ///< scene units, > 0
    double depth = 1;       ///< of the region along the normal, > 0, finite
    double density = 1;     ///< > 0
    Affinity affinity{};
};

/// The point form of [Falcone24]: a frustum; rays start on its near plane.
struct PointArea {
    Vec3d eye = {};        ///< finite
    Vec3d direction;       ///< any nonzero length
    double fov_x_deg = 90; ///< full field of view, in (0, 180)
    double fov_y_deg = 90; ///< full field of view, in (0, 180)
    double near = 0;       ///< >= 0; 0: the pyramid with its apex
    double far = 1;        ///< > near, finite
    Emission emission = Emission::pinhole;
    double density = 1; ///< > 0
    Affinity affinity{};
};

/// What InfluenceArea::measured takes.
struct MeasuredArea {
    MeasuredParams rays;
    std::optional<Region> region = {
    }; ///< nullopt: a box around the origins, along their mean direction
    double density = 1; ///< > 0, finite
    Affinity affinity{};
};

/// A region, the rays that belong to it, and a name. The makers validate every parameter and throw
/// Error that names the area; the aggregate itself can hold any region with any distribution.
struct InfluenceArea {
    std::string name; ///< not empty
    Region region;
    Distribution distribution;
    double density = 1;
    Affinity affinity{};

    [[nodiscard]] static InfluenceArea parallel(std::string name, const ParallelArea& area);
    [[nodiscard]] static InfluenceArea radial(std::string name, const RadialArea& area);
    [[nodiscard]] static InfluenceArea plane(std::string name, const PlaneArea& area);
    [[nodiscard]] static InfluenceArea point(std::string name, const PointArea& area);
    [[nodiscard]] static InfluenceArea measured(std::string name, MeasuredArea area);
};

/// Whether the ray starts in the region and follows the distribution within the area's tolerance.
/// Sign-agnostic: rays toward the light are as good as rays from it. A radial ray that starts at
/// the eye is affine. Uniform and measured areas have no line to follow: the origin decides. False
/// for an invalid ray.
[[nodiscard]] bool is_affine(const InfluenceArea& area, const Ray& ray);

/// What remains of `is_affine` for a ray that is known to be valid and to start in the region: a
/// few products, for the search of areas in a query.
[[nodiscard]] bool follows(const InfluenceArea& area, const Ray& ray);

/// Affine with tolerance zero: the ray lies in the pencil, that is, along the direction or through
/// the eye, up to the rounding of its float coordinates. Never for uniform and measured areas.
[[nodiscard]] bool is_exact(const InfluenceArea& area, const Ray& ray);

/// The world-axis box around `bounds` (not empty, finite; throws Error otherwise).
[[nodiscard]] Obb obb_around(const Aabb& bounds);

/// The box around `bounds` in frame_along(direction): its forward axis follows the rays.
[[nodiscard]] Obb obb_around(const Aabb& bounds, Vec3d direction);

} // namespace raywise
