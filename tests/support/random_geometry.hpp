// Random boxes, frames and regions for tests, and the slab test in plain double arithmetic.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <limits>

namespace raywise::testing {

inline Vec3d random_point(Rng& rng, double extent) {
    const double x = rng.uniform(-extent, extent);
    const double y = rng.uniform(-extent, extent);
    return {x, y, rng.uniform(-extent, extent)};
}

inline Frame random_frame(Rng& rng) {
    const Vec3d direction = sample_sphere(rng);
    return frame_along(direction, rng.uniform(-3, 3));
}

/// A box around `center` with half sizes up to `half`; one in eight is flat.
inline Aabb random_box(Rng& rng, Vec3d center, double half) {
    Vec3d size = abs(random_point(rng, half));
    if (rng.below(8) == 0) size[static_cast<int>(rng.below(3))] = 0;
    return {to_float(center - size), to_float(center + size)};
}

inline Obb random_obb(Rng& rng, double extent, double half) {
    const Vec3d center = random_point(rng, extent);
    const Frame frame = random_frame(rng);
    return {center, frame, abs(random_point(rng, half))};
}

/// One in three starts at the apex.
inline Frustum random_frustum(Rng& rng, double extent) {
    Frustum frustum;
    frustum.eye = random_point(rng, extent);
    frustum.frame = random_frame(rng);
    frustum.tan_x = rng.uniform(0.05, 1.5);
    frustum.tan_y = rng.uniform(0.05, 1.5);
    frustum.near = rng.below(3) == 0 ? 0 : rng.uniform(0.01, 0.5);
    frustum.far = frustum.near + rng.uniform(0.2, 2);
    return frustum;
}

inline Triangle random_triangle(Rng& rng, Vec3d center, double extent) {
    const Vec3 v0 = to_float(center + random_point(rng, extent));
    const Vec3 v1 = to_float(center + random_point(rng, extent));
    return {v0, v1, to_float(center + random_point(rng, extent))};
}

/// Whether origin + t direction is in the closed box for some t >= t_min. The textbook slabs, with
/// zero components as containment tests.
inline bool meets(const Aabb& box, Vec3d origin, Vec3d direction, double t_min = 0) {
    double entry = t_min;
    double exit = std::numeric_limits<double>::infinity();
    for (int axis = 0; axis < 3; ++axis) {
        const double lo = to_double(box.lo)[axis] - origin[axis];
        const double hi = to_double(box.hi)[axis] - origin[axis];
        if (direction[axis] == 0) {
            if (lo > 0 || hi < 0) return false;
            continue;
        }
        const double a = lo / direction[axis];
        const double b = hi / direction[axis];
        entry = std::max(entry, std::min(a, b));
        exit = std::min(exit, std::max(a, b));
    }
    return entry <= exit;
}

} // namespace raywise::testing
