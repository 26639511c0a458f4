#include <raywise/toplevel/open_place.hpp>

#include <raywise/core/ids.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace raywise {
namespace {

/// Squared distance to the segment; to a point where both ends coincide.
double squared_distance(Vec3d p, Vec3d a, Vec3d b) {
    const Vec3d along = b - a;
    const double size = dot(along, along);
    const double at = size > 0 ? std::clamp(dot(p - a, along) / size, 0.0, 1.0) : 0.0;
    const Vec3d off = p - (a + along * at);
    return dot(off, off);
}

/// Squared distance to the closed triangle: to its plane above its inside, else to its border.
double squared_distance(Vec3d p, const Triangle& triangle) {
    const Vec3d a = to_double(triangle.v0);
    const Vec3d b = to_double(triangle.v1);
    const Vec3d c = to_double(triangle.v2);
    const Vec3d normal = cross(b - a, c - a);
    const double u = dot(cross(b - a, p - a), normal);
    const double v = dot(cross(c - b, p - b), normal);
    const double w = dot(cross(a - c, p - c), normal);
    if (u > 0 && v > 0 && w > 0) {
        const double height = dot(p - a, normal);
        return height * height / dot(normal, normal);
    }
    return std::min(
        {squared_distance(p, a, b), squared_distance(p, b, c), squared_distance(p, c, a)}
    );
}

} // namespace

Vec3d find_open_place(const TriangleView& triangles, const Aabb& box, std::uint64_t seed) {
    constexpr std::uint64_t tries = 64;
    constexpr std::size_t enough = std::size_t{1} << 16U;
    const std::size_t step = std::max<std::size_t>(1, triangles.size() / enough);
    const Vec3d middle = to_double(box.center());
    const Vec3d size = to_double(box.hi) - to_double(box.lo);
    Vec3d best = middle;
    double best_room = -1;
    for (std::uint64_t i = 0; i < tries; ++i) {
        Rng rng(seed, i);
        const double x = rng.uniform(-0.25, 0.25);
        const double y = rng.uniform(-0.25, 0.25);
        const double z = rng.uniform(-0.25, 0.25);
        const Vec3d place = middle + Vec3d{x * size.x, y * size.y, z * size.z};
        double room = std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < triangles.size() && room > best_room; k += step) {
            room = std::min(room, squared_distance(place, triangles[to_prim(k)]));
        }
        if (room > best_room) {
            best_room = room;
            best = place;
        }
    }
    return best;
}

} // namespace raywise
