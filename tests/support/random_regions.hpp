// Random and degenerate regions, points and triangles.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <cmath>
#include <vector>

namespace raywise::test_support {

inline Vec3d random_point(Rng& rng, double lo, double hi) {
    const double x = rng.uniform(lo, hi);
    const double y = rng.uniform(lo, hi);
    return {x, y, rng.uniform(lo, hi)};
}

inline Vec3d random_direction(Rng& rng) {
    while (true) {
        const Vec3d v = random_point(rng, -1, 1);
        if (dot(v, v) > 1e-3 && dot(v, v) <= 1) return normalized(v);
    }
}

inline Aabb random_box(Rng& rng) {
    const Vec3d a = random_point(rng, -5, 5);
    const Vec3d size = random_point(rng, 0, 6);
    return {to_float(a), to_float(a + size)};
}

/// Half sizes 0 among them: flat boxes, sticks and points.
inline Obb random_obb(Rng& rng) {
    Obb box{
        random_point(rng, -5, 5),
        frame_along(random_direction(rng), rng.uniform(0, 6)),
        random_point(rng, 0.2, 4)
    };
    for (int axis = 0; axis < 3; ++axis) {
        if (rng.below(12) == 0) box.half[axis] = 0;
    }
    return box;
}

inline Frustum random_frustum(Rng& rng) {
    Frustum view;
    view.eye = to_double(to_float(random_point(rng, -6, 6)));
    view.frame = frame_along(random_direction(rng), rng.uniform(0, 6));
    view.tan_x = rng.uniform(0.1, 1.5);
    view.tan_y = rng.uniform(0.1, 1.5);
    view.near = rng.below(3) == 0 ? 0 : rng.uniform(0.1, 1);
    view.far = view.near + rng.uniform(0.5, 9);
    return view;
}

inline Region random_region(Rng& rng) {
    switch (rng.below(4)) {
    case 0:
        return random_box(rng);
    case 1:
        return random_frustum(rng);
    default:
        return random_obb(rng);
    }
}

inline std::vector<Region> random_regions(Rng& rng, std::size_t count) {
    std::vector<Region> regions;
    for (std::size_t i = 0; i < count; ++i) {
        regions.push_back(i > 0 && rng.below(10) == 0 ? regions[rng.below(i)] : random_region(rng));
    }
    return regions;
}

/// Small triangles, walls that span everything, and triangles of zero area.
inline Triangle random_triangle(Rng& rng) {
    const double size = rng.below(8) == 0 ? 20 : rng.uniform(0.1, 3);
    const Vec3d a = random_point(rng, -6, 6);
    const Vec3 v0 = to_float(a);
    const Vec3 v1 = to_float(a + random_point(rng, -size, size));
    const Vec3 v2 = to_float(a + random_point(rng, -size, size));
    switch (rng.below(16)) {
    case 0:
        return {v0, v1, v1};
    case 1:
        return {v0, v0, v0};
    default:
        return {v0, v1, v2};
    }
}

} // namespace raywise::test_support
