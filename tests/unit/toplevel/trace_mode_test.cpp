// The fast mode of accelerators: what it may answer otherwise than the watertight one, and what
// not.
#include "support/random_areas.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/accelerator.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

namespace raywise {
namespace {

using test_support::random_areas;
using test_support::random_ray;
using test_support::random_soup;

constexpr double tolerance = 1e-3; ///< of t relatively, and of weights

/// Whether the ray meets the triangle, a little larger, at about this t.
bool is_near_hit(const Ray& ray, const Triangle& triangle, float t) {
    const Vec3d o = to_double(ray.origin), d = to_double(ray.direction);
    const Vec3d a = to_double(triangle.v0) - o;
    const Vec3d e1 = to_double(triangle.v1) - to_double(triangle.v0);
    const Vec3d e2 = to_double(triangle.v2) - to_double(triangle.v0);
    const Vec3d normal = cross(e1, e2);
    const double sum = dot(d, normal);
    const double flatness = std::abs(sum) / (length(d) * length(normal));
    if (!(flatness > 0.01)) return true; // nearly in the plane, or without area: anything may be
    const double v = dot(e2, cross(a, d)) / sum, w = -dot(e1, cross(a, d)) / sum;
    const double error = std::abs(dot(a, normal) / sum - static_cast<double>(t));
    return std::min({v, w, 1 - v - w}) > -tolerance &&
           error < tolerance * std::max(1.0, static_cast<double>(t));
}

/// Whether the exact answer could not change by a little.
bool is_clear(const std::optional<Hit>& hit, const Ray& ray) {
    if (!hit) return false;
    const auto t = static_cast<double>(hit->t);
    const auto u = static_cast<double>(hit->u), v = static_cast<double>(hit->v);
    const bool is_inside = std::min({u, v, 1 - u - v}) > tolerance;
    return is_inside && t * (1 - tolerance) > static_cast<double>(ray.t_min) + tolerance &&
           t * (1 + tolerance) < static_cast<double>(ray.t_max) - tolerance;
}

TEST(TraceMode, FastAcceleratorsAgreeWithWatertightOnesAwayFromEdges) {
    std::size_t clear = 0;
    std::size_t different = 0;
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Rng rng(41, seed);
        const Scene scene = random_soup(rng, 1 + rng.below(300));
        const auto areas = random_areas(rng, rng.below(4));
        const Accelerator exact = build_accelerator(scene, areas);
        const Accelerator fast = exact.with_trace_mode(TraceMode::fast);
        std::vector<Ray> rays;
        for (int i = 0; i < 400; ++i)
            rays.push_back(random_ray(rng, scene, areas));
        std::vector<Hit> hits(rays.size());
        fast.closest_hits(rays, hits);
        const auto occluded = std::make_unique<bool[]>(rays.size());
        fast.any_hits(rays, {occluded.get(), rays.size()});
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const Ray& ray = rays[i];
            const auto expected = exact.closest_hit(ray);
            const auto found = fast.closest_hit(ray);
            for (const Hit& hit : {found.value_or(Hit{}), hits[i]}) {
                if (hit.prim == no_prim) continue;
                ASSERT_TRUE(is_valid(ray));
                ASSERT_GE(hit.t, ray.t_min);
                ASSERT_LE(hit.t, ray.t_max);
                ASSERT_NE(hit.prim, ray.excluded);
                ASSERT_TRUE(is_near_hit(ray, scene.view()[hit.prim], hit.t)) << seed << ' ' << i;
            }
            if (found.has_value() != expected.has_value()) ++different;
            if (!is_clear(expected, ray)) continue;
            ++clear;
            ASSERT_TRUE(found) << seed << ' ' << i;
            const auto most = static_cast<double>(expected->t) * (1 + tolerance);
            ASSERT_LE(static_cast<double>(found->t), most) << seed << ' ' << i;
            ASSERT_LE(static_cast<double>(hits[i].t), most) << seed << ' ' << i;
            ASSERT_TRUE(fast.any_hit(ray));
            ASSERT_TRUE(occluded[i]);
        }
    }
    EXPECT_GT(clear, 2000U);
    EXPECT_LT(different, 60U * 400U / 50U);
}

TEST(TraceMode, IsWatertightUnlessAskedFor) {
    EXPECT_EQ(AcceleratorParams{}.trace_mode, TraceMode::watertight);
    Rng rng(42);
    const Scene scene = random_soup(rng, 20);
    const Accelerator fast = build_accelerator(scene, {}, {.trace_mode = TraceMode::fast});
    EXPECT_EQ(fast.params().trace_mode, TraceMode::fast);
    EXPECT_EQ(
        fast.with_trace_mode(TraceMode::watertight).params().trace_mode, TraceMode::watertight
    );
}

} // namespace
} // namespace raywise
