// Every query, over trees and without, against an oracle that shares no code and no formula with
// the kernels: Moeller-Trumbore in doubles that carry their own error bounds, then rational
// numbers.
#include "support/exact_oracle.hpp"
#include "support/median_split.hpp"
#include "support/soup.hpp"
#include "verify/checks.hpp"

#include <raywise/build/binned.hpp>
#include <raywise/build/spatial.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/hit_measure.hpp>
#include <raywise/optimize/reinsertion.hpp>
#include <raywise/trace/all_hits.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <optional>
#include <vector>

namespace raywise::verify {

namespace {

using namespace test_support;

/// A double with a bound of its error that every operation keeps up: running error analysis.
struct Approximate {
    double value = 0;
    double error = 0;

    [[nodiscard]] static double unit(double x) { return std::abs(x) * 0x1p-52; }

    // The factor covers the rounding of the error terms themselves.
    [[nodiscard]] static Approximate with_error(double value, double error) {
        return {value, (error + unit(value)) * (1 + 0x1p-48)};
    }

    friend Approximate operator+(Approximate a, Approximate b) {
        return with_error(a.value + b.value, a.error + b.error);
    }

    friend Approximate operator-(Approximate a, Approximate b) {
        return with_error(a.value - b.value, a.error + b.error);
    }

    friend Approximate operator*(Approximate a, Approximate b) {
        return with_error(
            a.value * b.value,
            std::abs(a.value) * b.error + std::abs(b.value) * a.error + a.error * b.error
        );
    }

    [[nodiscard]] bool is_surely_positive() const { return value > error; }

    [[nodiscard]] bool is_surely_negative() const { return value < -error; }
};

struct Vec {
    Approximate x, y, z;

    explicit Vec(Vec3 a)
        : x{static_cast<double>(a.x)}, y{static_cast<double>(a.y)}, z{static_cast<double>(a.z)} {}

    Vec(Approximate x_in, Approximate y_in, Approximate z_in) : x(x_in), y(y_in), z(z_in) {}

    friend Vec operator-(const Vec& a, const Vec& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
};

Approximate dot(const Vec& a, const Vec& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

Vec cross(const Vec& a, const Vec& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The t of a hit, nothing for a miss; the same decision as oracle::intersect, sooner.
std::optional<float> expected_t(const Ray& ray, const Triangle& triangle, PrimId id) {
    const Vec o(ray.origin);
    const Vec d(ray.direction);
    const Vec v0(triangle.v0);
    const Vec edge1 = Vec(triangle.v1) - v0;
    const Vec edge2 = Vec(triangle.v2) - v0;
    const Vec p = cross(d, edge2);
    const Approximate volume = dot(edge1, p);
    if (id == ray.excluded) return std::nullopt;
    if (volume.is_surely_positive() || volume.is_surely_negative()) {
        const Approximate sign{volume.value > 0 ? 1.0 : -1.0};
        const Vec s = o - v0;
        const Vec q = cross(s, edge1);
        const Approximate u = dot(s, p) * sign;
        const Approximate v = dot(d, q) * sign;
        const Approximate w = volume * sign - u - v;
        if (u.is_surely_negative() || v.is_surely_negative() || w.is_surely_negative())
            return std::nullopt;
        const Approximate height = dot(edge2, q);
        const double t = height.value / volume.value;
        const double error = (height.error + std::abs(t) * volume.error) /
                                 (std::abs(volume.value) - volume.error) * (1 + 0x1p-40) +
                             std::abs(t) * 0x1p-50;
        const auto low = static_cast<float>(t - error);
        const auto high = static_cast<float>(t + error);
        if (high < ray.t_min || low > ray.t_max) return std::nullopt;
        const bool is_inside =
            u.is_surely_positive() && v.is_surely_positive() && w.is_surely_positive();
        if (is_inside && low == high && std::isfinite(low)) return low;
    }
    const std::optional<Hit> hit = oracle::intersect(ray, triangle, id);
    return hit ? std::optional(hit->t) : std::nullopt;
}

std::vector<Hit> expected_hits(const TriangleView& triangles, const Ray& ray) {
    std::vector<Hit> hits;
    if (!is_valid(ray)) return hits;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        if (const auto t = expected_t(ray, triangles[to_prim(i)], to_prim(i)))
            hits.push_back({*t, 0, 0, to_prim(i), false});
    std::sort(hits.begin(), hits.end(), is_closer);
    return hits;
}

bool same(const std::vector<Hit>& a, const std::vector<Hit>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](const Hit& x, const Hit& y) {
        return x.t == y.t && x.prim == y.prim;
    });
}

bool is_first(const std::optional<Hit>& hit, const std::vector<Hit>& hits) {
    if (hits.empty()) return !hit;
    return hit && hit->t == hits.front().t && hit->prim == hits.front().prim;
}

bool tree_is_right(
    const Bvh& tree,
    const TriangleView& triangles,
    const Ray& ray,
    const std::vector<Hit>& expected
) {
    const IndexedTriangles source(triangles);
    return is_first(closest_hit(tree, source, ray), expected) &&
           any_hit(tree, source, ray) == !expected.empty() &&
           same(sorted_hits(tree, source, ray), expected);
}

constexpr std::uint64_t rays_per_scene = 64;

Outcome check_scene(std::uint64_t seed, std::uint64_t index) {
    Rng rng(seed, index);
    const auto how = static_cast<Coordinates>(rng.below(4));
    const Soup soup = random_soup(rng, 64, how);
    const TriangleView view = soup.view();
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < view.size(); ++i)
        boxes.push_back(bounds(view[to_prim(i)]));
    const Bvh halves = median_split(view, 1 + index % 4);
    const Bvh binned = build_binned(boxes, SurfaceMeasure{});
    // Small leaves and much room, so that as many triangles as possible are cut, again and again.
    const Bvh cut = reinsert(
        build_spatial(
            view,
            SurfaceMeasure{},
            {.binned = {.max_leaf_size = 1, .cost = {.node = 0.01}}, .duplication = 8}
        ),
        SurfaceMeasure{},
        {.batch = 1}
    );
    Outcome outcome;
    for (; outcome.rays < rays_per_scene; ++outcome.rays) {
        const Ray ray = random_ray(rng, soup, how);
        const std::vector<Hit> expected = expected_hits(view, ray);
        const bool right = tree_is_right(halves, view, ray, expected) &&
                           tree_is_right(binned, view, ray, expected) &&
                           tree_is_right(cut, view, ray, expected) &&
                           same(brute_force_all_hits(view, ray), expected) &&
                           is_first(brute_force_closest_hit(view, ray), expected);
        if (right) continue;
        ++outcome.wrong;
        std::fprintf(
            stderr,
            "hits: scene %llu, ray %llu is wrong\n",
            static_cast<unsigned long long>(index),
            static_cast<unsigned long long>(outcome.rays)
        );
    }
    return outcome;
}

} // namespace

Outcome check_hits(const Options& options) {
    return for_scenes(options, rays_per_scene, [&](std::uint64_t index) {
        return check_scene(options.seed, index);
    });
}

} // namespace raywise::verify
