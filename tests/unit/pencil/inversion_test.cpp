#include <raywise/pencil/inversion.hpp>

#include "support/closed_mesh.hpp"
#include "support/soup.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray_triangle.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

constexpr float infinity = std::numeric_limits<float>::infinity();

Hit brute_force(const TriangleView& triangles, const Ray& ray) {
    Hit best;
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const std::optional<Hit> hit = intersect(ray, triangles[to_prim(i)], to_prim(i));
        if (hit && is_closer(*hit, best)) best = *hit;
    }
    return best;
}

std::vector<bool> ask_any(
    const TriangleView& triangles,
    const Pencil& pencil,
    const std::vector<Ray>& rays,
    int threads = 1
) {
    const auto hits = std::make_unique<bool[]>(rays.size());
    any_hits_once(triangles, pencil, rays, {hits.get(), rays.size()}, Executor(threads));
    return std::vector<bool>(hits.get(), hits.get() + rays.size());
}

std::vector<Hit> ask_closest(
    const TriangleView& triangles,
    const Pencil& pencil,
    const std::vector<Ray>& rays,
    int threads = 1
) {
    std::vector<Hit> hits(rays.size());
    closest_hits_once(triangles, pencil, rays, hits, Executor(threads));
    return hits;
}

/// The number of hits; adds a failure at the first ray that is answered otherwise.
std::size_t expect_brute_force(
    const TriangleView& triangles,
    const Pencil& pencil,
    const std::vector<Ray>& rays,
    int threads = 1
) {
    const std::vector<bool> any = ask_any(triangles, pencil, rays, threads);
    const std::vector<Hit> closest = ask_closest(triangles, pencil, rays, threads);
    std::size_t count = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const Hit expected = brute_force(triangles, rays[i]);
        const bool is_hit = expected.prim != no_prim;
        count += is_hit ? 1 : 0;
        const Hit& found = closest[i];
        if (any[i] != is_hit || found.prim != expected.prim || found.t != expected.t ||
            found.u != expected.u || found.v != expected.v || found.front != expected.front) {
            ADD_FAILURE() << "ray " << i << ": expected " << to_index(expected.prim) << " at "
                          << expected.t << ", found " << to_index(found.prim) << " at " << found.t
                          << ", any " << any[i];
            return count;
        }
    }
    return count;
}

/// Rays of the pencil that look for trouble, toward the emitter and away from it.
Ray pencil_ray(Rng& rng, const Pencil& pencil, const Soup& soup, Coordinates how) {
    const Ray wild = random_ray(rng, soup, how);
    Ray ray = wild;
    const bool leaves = rng.below(3) == 0;
    if (pencil.kind() == Pencil::Kind::parallel) {
        // Origins on surfaces, on vertices seen along the direction, anywhere.
        if (rng.below(2) == 0)
            ray.origin = wild.origin + wild.direction * (rng.below(2) == 0 ? 1 : rng.uniform());
        if (rng.below(3) == 0) ray.origin = ray.origin + pencil.direction() * coordinate(rng, how);
        ray.direction = leaves ? pencil.direction() : -pencil.direction();
        return ray;
    }
    if (leaves) {
        ray.origin = pencil.apex();
        ray.direction = wild.origin + wild.direction - pencil.apex();
        return ray;
    }
    if (rng.below(2) == 0) ray.origin = wild.origin + wild.direction;
    ray.direction = pencil.apex() - ray.origin;
    ray.t_max = std::min(1.0F, ray.t_max);
    ray.t_min = std::min(ray.t_min, ray.t_max);
    return ray;
}

Pencil random_pencil(Rng& rng, const Soup& soup, Coordinates how) {
    const auto vertex = [&] {
        return soup.vertices[static_cast<std::size_t>(rng.below(soup.vertices.size()))];
    };
    Vec3 value = point(rng, how);
    switch (rng.below(5)) {
    case 0:
        value = vertex();
        break;
    case 1:
        value = (vertex() + vertex()) * 0.5F;
        break;
    case 2:
        value = vertex() - vertex();
        break;
    case 3: {
        const int axis = static_cast<int>(rng.below(3));
        value = {};
        value[axis] = coordinate(rng, how);
        break;
    }
    default:
        break;
    }
    if (rng.below(2) == 0) return Pencil::radial(value);
    return Pencil::parallel(value == Vec3{} ? Vec3{0, 0, -1} : value);
}

TEST(Inversion, NoRaysAndNoTrianglesAreAnswered) {
    const Pencil sun = Pencil::parallel({0, 0, -1});
    EXPECT_TRUE(ask_any({}, sun, {}).empty());
    EXPECT_EQ(ask_any({}, sun, {sun.shadow_ray({1, 2, 3})}), std::vector<bool>{false});
    Soup soup;
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_TRUE(ask_closest(soup.view(), sun, {}).empty());
}

TEST(Inversion, RefusesRaysOfAnotherPencilAndTooFewAnswers) {
    Soup soup;
    soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Pencil sun = Pencil::parallel({0, 0, -1});
    const Pencil lamp = Pencil::radial({0, 0, 4});
    EXPECT_THROW(ask_any(soup.view(), sun, {{{0, 0, -1}, {0, 0.1F, 1}}}), Error);
    EXPECT_THROW(ask_closest(soup.view(), lamp, {{{0, 1, -1}, {0, 0.1F, 1}}}), Error);
    const std::vector<Ray> rays{sun.shadow_ray({})};
    EXPECT_THROW(any_hits_once(soup.view(), sun, rays, {}), Error);
    EXPECT_THROW(closest_hits_once(soup.view(), sun, rays, {}), Error);
}

TEST(Inversion, InvalidRaysHitNothing) {
    Soup soup;
    soup.add({{-9, -9, 0}, {9, -9, 0}, {0, 9, 0}});
    const Pencil sun = Pencil::parallel({0, 0, -1});
    std::vector<Ray> rays(5, sun.shadow_ray({0, 0, -1}));
    rays[1].t_min = -1;
    rays[2].origin.x = std::numeric_limits<float>::quiet_NaN();
    rays[3].direction = {};
    rays[4].t_min = infinity;
    EXPECT_EQ(
        ask_any(soup.view(), sun, rays), (std::vector<bool>{true, false, false, false, false})
    );
    EXPECT_EQ(ask_closest(soup.view(), sun, rays)[4].prim, no_prim);
}

TEST(Inversion, AgreesWithBruteForceOnSoups) {
    std::size_t hits = 0;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(41, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 48, how);
        const Pencil pencil = random_pencil(rng, soup, how);
        std::vector<Ray> rays(1 + static_cast<std::size_t>(rng.below(60)));
        for (Ray& ray : rays) {
            ray = pencil_ray(rng, pencil, soup, how);
            if (is_valid(ray) && !pencil.holds(ray)) ray.t_min = -1;
        }
        SCOPED_TRACE(i);
        hits += expect_brute_force(soup.view(), pencil, rays);
        if (HasFailure()) return;
    }
    EXPECT_GT(hits, 5000U);
}

/// A direction so small that t overflows: a hit at an infinite t is none.
TEST(Inversion, AgreesWithBruteForceWhereTOverflows) {
    Soup soup;
    soup.add({{-0x1p59F, 0x1.e2p29F, 0}, {0, 0x1.e2p29F, 0x1p52F}, {0x1p57F, 0x1.e2p29F, 0}});
    const Pencil pencil = Pencil::parallel({0, 0x1.5p-127F, 0});
    Ray ray{.origin = {0x1p-15F, 0, 0x1p50F}, .direction = pencil.direction(), .t_min = 0.25F};
    EXPECT_EQ(expect_brute_force(soup.view(), pencil, {ray}), 0U);
    ray.origin.y = 0x1.e2p29F;
    ray.t_min = 0;
    EXPECT_EQ(expect_brute_force(soup.view(), pencil, {ray}), 1U);
}

TEST(Inversion, AgreesWithBruteForceAtAllScales) {
    for (std::uint64_t i = 0; i < 300; ++i) {
        Rng rng(42, i);
        const auto how = rng.below(2) == 0 ? Coordinates::smooth : Coordinates::grid;
        Soup soup = random_soup(rng, 48, how);
        const float scale = std::pow(10.0F, static_cast<float>(rng.below(36)) - 20);
        const Vec3 shift = rng.below(2) == 0 ? Vec3{} : point(rng, how) * (100 * scale);
        for (Vec3& v : soup.vertices)
            v = v * scale + shift;
        Pencil pencil = Pencil::parallel(point(rng, Coordinates::smooth) * scale);
        if (rng.below(2) == 0) pencil = Pencil::radial(point(rng, how) * scale + shift);
        std::vector<Ray> rays(50);
        for (Ray& ray : rays) {
            const Vec3 at = point(rng, how) * scale + shift;
            ray = pencil.shadow_ray(at);
            if (rng.below(3) == 0)
                ray = pencil.kind() == Pencil::Kind::parallel
                          ? Ray{at, pencil.direction()}
                          : Ray{pencil.apex(), at - pencil.apex()};
        }
        SCOPED_TRACE(i);
        static_cast<void>(expect_brute_force(soup.view(), pencil, rays));
        if (HasFailure()) return;
    }
}

/// Many small triangles and many rays, so that tiles, bins and rows are many.
TEST(Inversion, AgreesWithBruteForceOnManyTilesForAnyNumberOfThreads) {
    std::size_t hits = 0;
    for (std::uint64_t i = 0; i < 12; ++i) {
        Rng rng(43, i);
        Soup soup;
        for (int k = 0; k < 300; ++k) {
            const Vec3 center = point(rng, Coordinates::smooth);
            const float size = rng.below(20) == 0 ? 1 : 0.05F;
            soup.add(
                {center + point(rng, Coordinates::smooth) * size,
                 center + point(rng, Coordinates::smooth) * size,
                 center + point(rng, Coordinates::smooth) * size}
            );
        }
        const Vec3 value = point(rng, Coordinates::smooth) * (i < 4 ? 0.5F : 3.0F);
        const Pencil pencil = i % 2 == 0 ? Pencil::parallel(value) : Pencil::radial(value);
        std::vector<Ray> rays(6000);
        for (Ray& ray : rays) {
            // A dense spot beside a sparse rest.
            const Vec3 at = point(rng, Coordinates::smooth) * (rng.below(2) == 0 ? 1 : 0.03F);
            ray = pencil.shadow_ray(at);
            if (rng.below(4) == 0)
                ray = i % 2 == 0 ? Ray{at, pencil.direction()}
                                 : Ray{pencil.apex(), at - pencil.apex()};
        }
        SCOPED_TRACE(i);
        hits += expect_brute_force(soup.view(), pencil, rays, 1 + static_cast<int>(i % 3));
        if (HasFailure()) return;
    }
    EXPECT_GT(hits, 10000U);
}

TEST(Inversion, ClosedMeshesDoNotLeak) {
    std::uint64_t seed = 0;
    for (const ClosedMesh& mesh : {icosphere(2), torus(16, 8), grid_box(4)}) {
        Soup soup;
        for (const Vec3d& v : mesh.vertices)
            soup.vertices.push_back(to_float(v));
        soup.corners = mesh.corners;
        for (int k = 0; k < 6; ++k) {
            Rng rng(44, seed++);
            const Vec3 outside = normalized(point(rng, Coordinates::smooth)) * 5.0F;
            const Pencil pencil = k % 2 == 0 ? Pencil::parallel(k == 0 ? Vec3{0, 0, -1} : outside)
                                             : Pencil::radial(k == 1 ? Vec3{0, 0, 4} : outside);
            std::vector<Ray> rays;
            // From vertices, middles of edges and the center of each face, both inside.
            for (const auto& corner : soup.corners) {
                const Vec3 a = soup.vertices[corner[0]];
                const Vec3 b = soup.vertices[corner[1]];
                const Vec3 c = soup.vertices[corner[2]];
                for (const Vec3 p : {a, (a + b) * 0.5F, (a + b + c) * (1.0F / 3)})
                    for (const float s : {1.0F, 0.9F})
                        rays.push_back(pencil.shadow_ray(p * s, k < 3 ? 0 : 1e-3F));
            }
            SCOPED_TRACE(seed);
            EXPECT_GT(expect_brute_force(soup.view(), pencil, rays), rays.size() / 4);
            if (HasFailure()) return;
        }
    }
}

TEST(Inversion, RaysOnOneLineAreAnswered) {
    Rng rng(45);
    const Soup soup = random_soup(rng, 100, Coordinates::smooth);
    const Pencil sun = Pencil::parallel({0.3F, 0.2F, -1});
    const Pencil lamp = Pencil::radial({0.1F, 0.2F, 3});
    std::vector<Ray> to_sun;
    std::vector<Ray> to_lamp;
    for (int i = 0; i < 3000; ++i) {
        to_sun.push_back(sun.shadow_ray({0.1F, 0.1F, -1}, rng.uniform()));
        to_lamp.push_back(lamp.shadow_ray({0.1F, 0.1F, -1}, rng.uniform()));
    }
    static_cast<void>(expect_brute_force(soup.view(), sun, to_sun));
    static_cast<void>(expect_brute_force(soup.view(), lamp, to_lamp));
}

TEST(Inversion, MemoryIsAFewDozenBytesPerRay) {
    EXPECT_LT(inversion_bytes(1'000'000), 100'000'000U);
}

TEST(Inversion, PredictionGrowsWithRaysAndTriangles) {
    constexpr auto kind = Pencil::Kind::parallel;
    EXPECT_EQ(predicted_inversion_ns(kind, 0, 0), 0);
    EXPECT_GT(predicted_inversion_ns(kind, 2000, 500), predicted_inversion_ns(kind, 1000, 500));
    EXPECT_GT(predicted_inversion_ns(kind, 1000, 900), predicted_inversion_ns(kind, 1000, 500));
}

} // namespace
} // namespace raywise
