// The slab tests accept every box that holds an exact hit: the triangle's own box, larger ones, and
// the smallest one around the hit point, with the interval cut to the hit's t.
#include "support/exact_oracle.hpp"
#include "support/soup.hpp"
#include "verify/checks.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray_box.hpp>
#include <raywise/geometry/ray_triangle.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <limits>

namespace raywise::verify {

namespace {

using namespace test_support;

bool is_accepted(const Ray& ray, const Aabb& box) {
    const auto limit = static_cast<double>(ray.t_max);
    if (!WideSlab(ray)(box, limit).hit) return false;
    return needs_wide_slab(ray) || Slab(ray)(box, ray.t_max).hit;
}

/// The smallest box of floats around the exact point where the ray meets the triangle's plane.
Aabb box_of_hit_point(const Ray& ray, const Triangle& triangle) {
    using oracle::fraction;
    const int unit = std::min(
        {oracle::last_bit(ray.origin),
         oracle::last_bit(triangle.v0),
         oracle::last_bit(triangle.v1),
         oracle::last_bit(triangle.v2)}
    );
    const int direction_unit = oracle::last_bit(ray.direction);
    const oracle::Integer3 o = oracle::in_units(ray.origin, unit);
    const oracle::Integer3 d = oracle::in_units(ray.direction, direction_unit);
    const oracle::Integer3 v0 = oracle::in_units(triangle.v0, unit);
    const oracle::Integer3 n = oracle::cross(
        oracle::in_units(triangle.v1, unit) - v0, oracle::in_units(triangle.v2, unit) - v0
    );
    const mpz_class rise = oracle::dot(n, v0 - o);
    const mpz_class slope = oracle::dot(n, d);
    const auto below = [](const mpq_class& x) {
        const float near = oracle::nearest_float(x);
        return mpq_class(static_cast<double>(near)) <= x
                   ? near
                   : std::nextafter(near, -std::numeric_limits<float>::infinity());
    };
    const auto coordinate = [&](const mpz_class& from, const mpz_class& along) {
        return fraction(from * slope + rise * along, slope, unit);
    };
    const mpq_class x = coordinate(o.x, d.x);
    const mpq_class y = coordinate(o.y, d.y);
    const mpq_class z = coordinate(o.z, d.z);
    return {{below(x), below(y), below(z)}, {-below(-x), -below(-y), -below(-z)}};
}

constexpr std::uint64_t rays_per_scene = 256;

Outcome check_scene(std::uint64_t seed, std::uint64_t index) {
    Rng rng(seed, index);
    const auto how = static_cast<Coordinates>(rng.below(4));
    const Soup soup = random_soup(rng, 8, how);
    Outcome outcome;
    // Scenes of nothing but degenerate triangles never reach their number of hits.
    for (int attempt = 0; attempt < 20000 && outcome.rays < rays_per_scene; ++attempt) {
        Ray ray = random_ray(rng, soup, how);
        const Triangle triangle =
            soup.view()[to_prim(static_cast<std::size_t>(rng.below(soup.corners.size())))];
        const auto hit = intersect(ray, triangle);
        if (!hit) continue;
        ++outcome.rays;
        ray.t_max = hit->t;
        if (rng.below(2) == 0) ray.t_min = hit->t;
        const Aabb own = bounds(triangle);
        const Aabb larger = unite(own, point(rng, how));
        const Aabb smallest = rng.below(64) == 0 ? box_of_hit_point(ray, triangle) : own;
        if (is_accepted(ray, own) && is_accepted(ray, larger) && is_accepted(ray, smallest))
            continue;
        ++outcome.wrong;
        std::fprintf(
            stderr,
            "slabs: scene %llu, attempt %d refuses a box that is hit\n",
            static_cast<unsigned long long>(index),
            attempt
        );
    }
    return outcome;
}

} // namespace

Outcome check_slabs(const Options& options) {
    return for_scenes(options, rays_per_scene, [&](std::uint64_t index) {
        return check_scene(options.seed, index);
    });
}

} // namespace raywise::verify
