// Random triangle soups and rays, a third of them degenerate, for tests of queries.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise::test_support {

struct Soup {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> corners;

    void add(const Triangle& triangle) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), {triangle.v0, triangle.v1, triangle.v2});
        corners.push_back({first, first + 1, first + 2});
    }

    [[nodiscard]] TriangleView view() const { return {vertices, corners}; }
};

/// How a soup's coordinates are drawn; one way for a whole soup, so that its triangles meet.
enum class Coordinates : std::uint8_t {
    smooth, ///< 24 random bits in [-1, 1)
    grid,   ///< integers in [-2, 2]: shared edges, coplanar faces, exact ties
    mixed,  ///< from 2^-30 to 2^12, each at its own scale
    wild,   ///< from the denormals to 2^60
};

inline float coordinate(Rng& rng, Coordinates how) {
    const float sign = (rng.bits() & 1U) != 0 ? -1.0F : 1.0F;
    switch (how) {
    case Coordinates::smooth:
        return sign * rng.uniform();
    case Coordinates::grid:
        return static_cast<float>(rng.below(5)) - 2;
    case Coordinates::mixed:
        return sign * std::ldexp(rng.uniform(), static_cast<int>(rng.below(42)) - 30);
    case Coordinates::wild:
        break;
    }
    return sign * std::ldexp(1 + rng.uniform(), static_cast<int>(rng.below(209)) - 149);
}

inline Vec3 point(Rng& rng, Coordinates how) {
    return {coordinate(rng, how), coordinate(rng, how), coordinate(rng, how)};
}

/// A triangle that some code somewhere gets wrong.
inline Triangle degenerate_triangle(Rng& rng, Coordinates how, const Soup& soup) {
    Triangle t{point(rng, how), point(rng, how), point(rng, how)};
    const auto old_vertex = [&] {
        return soup.vertices.empty()
                   ? point(rng, how)
                   : soup.vertices[static_cast<std::size_t>(rng.below(soup.vertices.size()))];
    };
    switch (rng.below(7)) {
    case 0:
        t.v2 = t.v0;
        break; // an edge
    case 1:
        t.v1 = t.v2 = t.v0;
        break; // a point
    case 2:
        t.v2 = t.v0 + (t.v1 - t.v0) * rng.uniform();
        break; // a sliver
    case 3:
        t = {old_vertex(), old_vertex(), t.v2};
        break; // a shared edge
    case 4:
        t = {old_vertex(), old_vertex(), old_vertex()};
        break; // a duplicate, often
    case 5:
        t.v1.y = t.v2.y = t.v0.y;
        break; // axis-aligned
    default: {
        // The same triangle as an older one, at another place in memory and turned.
        if (soup.corners.empty()) break;
        const std::size_t base = 3 * static_cast<std::size_t>(rng.below(soup.corners.size()));
        t = {soup.vertices[base + 1], soup.vertices[base + 2], soup.vertices[base]};
    }
    }
    return t;
}

/// 1 to `most` triangles, a third of them degenerate.
inline Soup random_soup(Rng& rng, std::size_t most, Coordinates how) {
    Soup soup;
    const std::size_t count = 1 + static_cast<std::size_t>(rng.below(most));
    while (soup.corners.size() < count)
        soup.add(
            rng.below(3) == 0 ? degenerate_triangle(rng, how, soup)
                              : Triangle{point(rng, how), point(rng, how), point(rng, how)}
        );
    return soup;
}

/// Rays that look for trouble: axis-parallel, toward vertices, edges and centroids, starting on
/// surfaces, with intervals that end about where something is hit.
inline Ray random_ray(Rng& rng, const Soup& soup, Coordinates how) {
    const auto any = [&](std::size_t count) { return static_cast<std::size_t>(rng.below(count)); };
    const std::size_t base = 3 * any(soup.corners.size());
    const Vec3 a = soup.vertices[base];
    const Vec3 b = soup.vertices[base + 1];
    const Vec3 c = soup.vertices[base + 2];
    Ray ray;
    ray.origin = point(rng, how);
    if (rng.below(5) == 0) { // on a surface, as near as floats allow
        const float u = rng.below(3) == 0 ? 0 : rng.uniform();
        ray.origin = a + (b - a) * u + (c - a) * ((1 - u) * rng.uniform());
        ray.excluded = rng.below(2) == 0 ? to_prim(base / 3) : no_prim;
    }
    switch (rng.below(6)) {
    case 0:
        ray.direction = point(rng, how);
        break;
    case 1: { // along an axis, through a vertex as seen along it
        const int axis = static_cast<int>(any(3));
        const float sign = (rng.bits() & 1U) != 0 ? -1.0F : 1.0F;
        const float away = ray.origin[axis];
        ray.origin = a;
        ray.origin[axis] = away;
        ray.direction = {0, -0.0F, 0};
        ray.direction[axis] = sign * (rng.below(2) == 0 ? 1 : std::abs(coordinate(rng, how)));
        break;
    }
    case 2:
        ray.direction = b - ray.origin;
        break;
    case 3:
        ray.direction = (a + (b - a) * rng.uniform()) - ray.origin;
        break;
    case 4:
        ray.direction = (a * (1.0F / 3) + b * (1.0F / 3) + c * (1.0F / 3)) - ray.origin;
        break;
    default:
        ray.direction = (a + (b - a) * 0.5F) - ray.origin;
        break;
    }
    switch (rng.below(6)) {
    case 0:
        ray.t_max = 1;
        break; // a segment to the point aimed at
    case 1:
        ray.t_min = ray.t_max = 1;
        break;
    case 2:
        ray.t_min = rng.uniform() * 0.5F;
        break;
    case 3:
        ray.t_max = 4 * rng.uniform();
        break;
    default:
        break;
    }
    return ray;
}

} // namespace raywise::test_support
