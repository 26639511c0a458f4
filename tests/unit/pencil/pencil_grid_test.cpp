#include <raywise/pencil/pencil_grid.hpp>

#include "support/closed_mesh.hpp"
#include "support/soup.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/ray_triangle.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

constexpr float infinity = std::numeric_limits<float>::infinity();

std::vector<Hit> brute_force(const TriangleView& triangles, const Ray& ray) {
    std::vector<Hit> hits;
    for (std::size_t i = 0; i < triangles.size(); ++i)
        if (const auto hit = intersect(ray, triangles[to_prim(i)], to_prim(i)))
            hits.push_back(*hit);
    std::sort(hits.begin(), hits.end(), is_closer);
    return hits;
}

/// How often grids did not know.
struct Tally {
    int queries = 0;
    int unknown_any = 0;
    int unknown_closest = 0;
};

void expect_same_as_brute_force(
    const PencilGrid& grid,
    const TriangleView& triangles,
    const Ray& ray,
    Tally& tally
) {
    ASSERT_TRUE(is_valid(ray) && grid.pencil().holds(ray));
    const std::vector<Hit> expected = brute_force(triangles, ray);
    const Verdict wanted = expected.empty() ? Verdict::miss : Verdict::hit;
    ++tally.queries;
    const Verdict any = grid.any_hit(ray);
    if (any == Verdict::unknown) {
        ++tally.unknown_any;
    } else {
        ASSERT_EQ(any, wanted);
    }
    PencilGridCounts counts;
    EXPECT_EQ(grid.any_hit(ray, counts), any);
    EXPECT_EQ(counts.queries, 1U);
    Hit hit;
    const Verdict closest = grid.closest_hit(ray, hit);
    if (closest == Verdict::unknown) {
        ++tally.unknown_closest;
    } else {
        ASSERT_EQ(closest, wanted);
        if (!expected.empty()) {
            EXPECT_EQ(hit.t, expected.front().t);
            EXPECT_EQ(hit.prim, expected.front().prim);
            EXPECT_EQ(hit.front, expected.front().front);
        }
    }
    std::vector<Hit> all;
    const Verdict complete = grid.all_hits(ray, [&](const Hit& h) { all.push_back(h); });
    if (complete != Verdict::unknown) {
        EXPECT_EQ(complete, wanted);
        std::sort(all.begin(), all.end(), is_closer);
        ASSERT_EQ(all.size(), expected.size());
        for (std::size_t i = 0; i < all.size(); ++i)
            EXPECT_EQ(all[i].prim, expected[i].prim);
    }
}

Vec3 some_vertex(Rng& rng, const Soup& soup) {
    return soup.vertices[static_cast<std::size_t>(rng.below(soup.vertices.size()))];
}

/// On a triangle, on one of its edges or at a vertex, as near as floats allow.
Vec3 surface_point(Rng& rng, const Soup& soup, PrimId& prim) {
    const auto triangle = static_cast<std::size_t>(rng.below(soup.corners.size()));
    prim = to_prim(triangle);
    const Vec3 a = soup.vertices[3 * triangle];
    const Vec3 b = soup.vertices[3 * triangle + 1];
    const Vec3 c = soup.vertices[3 * triangle + 2];
    const float u = rng.below(3) == 0 ? 0 : rng.uniform();
    const float v = rng.below(3) == 0 ? 0 : (1 - u) * rng.uniform();
    return a + (b - a) * u + (c - a) * v;
}

/// A ray of the pencil that looks for trouble.
Ray random_pencil_ray(Rng& rng, const Pencil& pencil, const Soup& soup, Coordinates how) {
    PrimId prim = no_prim;
    const Vec3 target = rng.below(3) == 0   ? point(rng, how)
                        : rng.below(3) == 0 ? some_vertex(rng, soup)
                                            : surface_point(rng, soup, prim);
    const PrimId excluded = rng.below(2) == 0 ? prim : no_prim;
    const float t_min = rng.below(3) == 0 ? 0 : rng.uniform() * (rng.below(2) == 0 ? 1e-4F : 1);
    Ray ray = pencil.shadow_ray(target, t_min, excluded);
    if (rng.below(4) == 0) { // away from the emitter
        if (pencil.kind() == Pencil::Kind::parallel) {
            ray.direction = pencil.direction();
            if (rng.below(2) == 0) ray.origin = target - pencil.direction() * 8.0F;
            ray.t_max = infinity;
        } else {
            ray.origin = pencil.apex();
            ray.direction = target - pencil.apex();
            ray.t_max = infinity;
        }
    }
    if (rng.below(4) == 0) ray.t_max = std::min(ray.t_max, ray.t_min + rng.uniform());
    return ray;
}

Pencil random_pencil(Rng& rng, const Soup& soup, Coordinates how) {
    switch (rng.below(6)) {
    case 0: { // along an axis
        Vec3 direction{};
        direction[static_cast<int>(rng.below(3))] = rng.below(2) == 0 ? 1.0F : -2.5F;
        return Pencil::parallel(direction);
    }
    case 1: { // along an edge, often
        const Vec3 direction = some_vertex(rng, soup) - some_vertex(rng, soup);
        if (direction != Vec3{} && is_finite(direction)) return Pencil::parallel(direction);
        return Pencil::parallel({1, 1, 1});
    }
    case 2:
        return Pencil::parallel(Vec3{rng.uniform() - 0.5F, rng.uniform() - 0.5F, 0.3F});
    case 3:
        return Pencil::radial(some_vertex(rng, soup));
    case 4: {
        PrimId prim = no_prim;
        return Pencil::radial(surface_point(rng, soup, prim));
    }
    default:
        return Pencil::radial(point(rng, how));
    }
}

void compare_on_soups(Coordinates how, std::uint64_t seed, int soups, std::size_t most) {
    Tally tally;
    for (int i = 0; i < soups && !testing::Test::HasFatalFailure(); ++i) {
        Rng rng(seed, static_cast<std::uint64_t>(i));
        const Soup soup = random_soup(rng, most, how);
        const Pencil pencil = random_pencil(rng, soup, how);
        PencilGridParams params;
        params.cell_size = rng.uniform(1, 9);
        params.leaf_size = 4 + static_cast<std::uint32_t>(rng.below(24));
        params.bytes_per_triangle = 1e9;
        PencilGrid grid = build_pencil_grid(soup.view(), pencil, params);
        const auto sets = PencilGrid::instruction_sets();
        for (int k = 0; k < 60 && !testing::Test::HasFatalFailure(); ++k) {
            grid.use_instruction_set(sets[static_cast<std::size_t>(rng.below(sets.size()))]);
            const Ray ray = random_pencil_ray(rng, pencil, soup, how);
            if (!is_valid(ray)) continue;
            SCOPED_TRACE(testing::Message() << "soup " << i << ", ray " << k);
            expect_same_as_brute_force(grid, soup.view(), ray, tally);
        }
    }
    EXPECT_LT(tally.unknown_any, tally.queries / 4) << tally.queries;
    EXPECT_LT(tally.unknown_closest, tally.queries / 2) << tally.queries;
}

TEST(PencilGrid, AgreesWithBruteForceOnSmoothSoups) {
    compare_on_soups(Coordinates::smooth, 11, 150, 60);
    compare_on_soups(Coordinates::smooth, 12, 12, 1500);
}

TEST(PencilGrid, AgreesWithBruteForceOnSoupsOfTies) {
    compare_on_soups(Coordinates::grid, 13, 250, 80);
}

TEST(PencilGrid, AgreesWithBruteForceOnSoupsOfManyScales) {
    compare_on_soups(Coordinates::mixed, 14, 150, 60);
}

TEST(PencilGrid, AgreesWithBruteForceFromDenormalsTo2To60) {
    compare_on_soups(Coordinates::wild, 15, 150, 60);
}

/// A room of large walls, each in two triangles, with small ones in it: one triangle spans from
/// near the lamp to far away, many in one cell.
Soup room(Rng& rng, int small) {
    Soup soup;
    for (int axis = 0; axis < 3; ++axis)
        for (const float side : {0.0F, 1.0F}) {
            std::array<Vec3, 4> corners{};
            for (std::size_t k = 0; k < 4; ++k) {
                corners[k][axis] = side;
                corners[k][(axis + 1) % 3] = k == 1 || k == 2 ? 8.0F : -8.0F;
                corners[k][(axis + 2) % 3] = k >= 2 ? 8.0F : -8.0F;
            }
            soup.add({corners[0], corners[1], corners[2]});
            soup.add({corners[0], corners[2], corners[3]});
        }
    for (int i = 0; i < small; ++i) {
        const Vec3 at{rng.uniform(), rng.uniform(), rng.uniform()};
        const auto near = [&] {
            return at + Vec3{rng.uniform(), rng.uniform(), rng.uniform()} * 0.1F;
        };
        soup.add({near(), near(), near()});
    }
    return soup;
}

TEST(PencilGrid, AgreesWithBruteForceOnWallsSeenFromTheirEdge) {
    Tally tally;
    for (int i = 0; i < 60 && !testing::Test::HasFatalFailure(); ++i) {
        Rng rng(23, static_cast<std::uint64_t>(i));
        const Soup soup = room(rng, i % 3 == 0 ? 0 : 20);
        Vec3 lamp{rng.uniform(), rng.uniform(), rng.uniform()};
        // As near to a wall's plane as 2^-24, also behind it, or on it.
        const float near = std::ldexp(1.0F, -static_cast<int>(rng.below(25)));
        lamp[static_cast<int>(rng.below(3))] = i % 5 == 0 ? 0 : i % 2 == 0 ? near : 1 - near;
        const Pencil pencil =
            i % 7 == 6 ? Pencil::parallel(lamp + Vec3{-0.5F, near, 0.125F}) : Pencil::radial(lamp);
        PencilGridParams params;
        params.bytes_per_triangle = 1e9;
        params.cell_size = i % 4 == 0 ? 1 : 16;
        PencilGrid grid = build_pencil_grid(soup.view(), pencil, params);
        const auto sets = PencilGrid::instruction_sets();
        for (int k = 0; k < 600 && !testing::Test::HasFatalFailure(); ++k) {
            grid.use_instruction_set(sets[static_cast<std::size_t>(rng.below(sets.size()))]);
            Ray ray = random_pencil_ray(rng, pencil, soup, Coordinates::smooth);
            // A hair before the surface, or a hair behind.
            if (rng.below(2) == 0)
                ray.t_min = std::ldexp(rng.uniform(), -static_cast<int>(rng.below(24)));
            if (!is_valid(ray)) continue;
            SCOPED_TRACE(testing::Message() << "room " << i << ", ray " << k);
            expect_same_as_brute_force(grid, soup.view(), ray, tally);
        }
    }
    EXPECT_LT(tally.unknown_any, tally.queries / 4) << tally.queries;
}

/// Found by a longer run: the product of three such differences is no float.
TEST(PencilGrid, KnowsTheClosestHitWhereProductsOverflow) {
    Soup soup;
    soup.add(
        {{-0x1.17bp-135F, -0x1.1dcdecp-60F, -0x1.971dp-112F},
         {-0x1.1e35c8p+3F, 0x1.e297p-131F, 0x1.e216a6p+41F},
         {-0x1.e57816p-84F, 0x1.99d068p+45F, -0x1.8p-146F}}
    );
    const Pencil pencil = Pencil::radial({-0x1.f91812p+2F, 0x1.3ba8cep+42F, 0x1.a96308p+41F});
    const PencilGrid grid = build_pencil_grid(soup.view(), pencil);
    const Ray ray = pencil.shadow_ray({0x1.6f55eap+44F, -0x1.014bccp+28F, -0x1.b392dep-51F});
    Tally tally;
    expect_same_as_brute_force(grid, soup.view(), ray, tally);
    EXPECT_EQ(tally.unknown_closest, 0);
}

TEST(PencilGrid, OverNothingIsNeverHit) {
    const Soup empty;
    for (const Pencil& pencil : {Pencil::parallel({0, -1, 0}), Pencil::radial({1, 2, 3})}) {
        const PencilGrid grid = build_pencil_grid(empty.view(), pencil);
        EXPECT_EQ(grid.occluded({4, 5, 6}), Verdict::miss);
        Hit hit;
        EXPECT_EQ(grid.closest_hit(pencil.shadow_ray({4, 5, 6}), hit), Verdict::miss);
    }
}

TEST(PencilGrid, LeavesOutTrianglesThatAreNotFinite) {
    Soup soup;
    soup.add({{0, 0, infinity}, {1, 0, 0}, {0, 1, 0}});
    soup.add({{0, 0, 0}, {1, 0, std::numeric_limits<float>::quiet_NaN()}, {0, 1, 0}});
    soup.add({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    const PencilGrid grid = build_pencil_grid(soup.view(), Pencil::parallel({0, 0, -1}));
    EXPECT_EQ(grid.occluded({0.25F, 0.25F, 0}), Verdict::hit);
    EXPECT_EQ(grid.occluded({0.25F, 0.25F, 0}, 0, PrimId{2}), Verdict::miss);
    EXPECT_EQ(grid.occluded({0.25F, 0.25F, 2}), Verdict::miss);
}

TEST(PencilGrid, TakesPointsThatAreNoPlacesForAMiss) {
    Soup soup;
    soup.add({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (const Pencil& pencil : {Pencil::parallel({0, 0, -1}), Pencil::radial({0, 0, 3})}) {
        const PencilGrid grid = build_pencil_grid(soup.view(), pencil);
        EXPECT_EQ(grid.occluded({nan, 0, 0}), Verdict::miss);
        EXPECT_EQ(grid.occluded({infinity, 0, 0}), Verdict::miss);
        EXPECT_EQ(grid.occluded({0, 0, -infinity}), Verdict::miss);
        EXPECT_EQ(grid.occluded({0, 0, 3}), Verdict::miss);
    }
}

TEST(PencilGrid, KnowsNothingOfOtherPencilsRaysAndMissesInvalidOnes) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    Soup soup;
    soup.add({{-4, -4, 1}, {4, -4, 1}, {0, 8, 1}});
    soup.add({{-1, -1, 3}, {1, -1, 3}, {0, 2, 3}}); // at the apex of the third pencil
    for (const Pencil& pencil :
         {Pencil::parallel({0, 0, -1}), Pencil::radial({0, 0, 5}), Pencil::radial({0, 0, 3})}) {
        const PencilGrid grid = build_pencil_grid(soup.view(), pencil);
        const Ray shadow = pencil.shadow_ray({0.125F, 0.25F, 0});
        std::vector<Ray> rays(80, shadow);
        std::vector<Verdict> wanted(80, Verdict::hit);
        const auto put = [&](std::size_t i, const Ray& ray, Verdict verdict) {
            rays[i] = ray;
            wanted[i] = verdict;
        };
        const auto changed = [&](auto&& change) {
            Ray ray = shadow;
            change(ray);
            return ray;
        };
        put(1, changed([](Ray& r) { r.direction.x += 0.5F; }), Verdict::unknown);
        put(3, {{1, 2, 0}, {0.5F, 0, 1}}, Verdict::unknown);
        put(35, changed([](Ray& r) { r.direction = {}; }), Verdict::miss);
        put(36, changed([](Ray& r) { r.direction.y = nan; }), Verdict::miss);
        put(37, changed([](Ray& r) { r.direction.z = infinity; }), Verdict::miss);
        put(38, changed([](Ray& r) { r.origin.z = nan; }), Verdict::miss);
        put(39, changed([](Ray& r) { r.t_min = -1; }), Verdict::miss);
        put(40, changed([](Ray& r) { r.t_min = nan; }), Verdict::miss);
        put(41, changed([](Ray& r) { r.t_max = nan; }), Verdict::miss);
        put(42, changed([](Ray& r) { std::swap(r.t_min, r.t_max); }), Verdict::miss);
        if (pencil.kind() == Pencil::Kind::radial) {
            const Vec3 apex = pencil.apex();
            put(65, {apex, {}}, Verdict::miss);
            put(66, {apex, {nan, 0, -1}}, Verdict::miss);
            put(67, {apex, {0, -infinity, 0}}, Verdict::miss);
            put(68, {apex, {0, 0, -1}, 0, nan}, Verdict::miss);
            put(69, {apex, {0, 0, -1}, 0, -1}, Verdict::miss);
        }
        const auto any = std::make_unique<bool[]>(rays.size());
        std::vector<Hit> closest(rays.size());
        std::size_t asked = 0;
        grid.any_hits(rays, {any.get(), rays.size()}, [&](const Ray&) { return ++asked > 0; });
        grid.closest_hits(rays, closest, [&](const Ray&) { return Hit{.prim = PrimId{9}}; });
        for (std::size_t i = 0; i < rays.size(); ++i) {
            SCOPED_TRACE(i);
            Hit hit;
            EXPECT_EQ(grid.any_hit(rays[i]), wanted[i]);
            EXPECT_EQ(grid.closest_hit(rays[i], hit), wanted[i]);
            EXPECT_EQ(grid.all_hits(rays[i], [](const Hit&) {}), wanted[i]);
            EXPECT_EQ(any[i], wanted[i] != Verdict::miss);
            EXPECT_EQ(closest[i].prim == no_prim, wanted[i] == Verdict::miss);
            EXPECT_EQ(closest[i].prim == PrimId{9}, wanted[i] == Verdict::unknown);
        }
        EXPECT_EQ(asked, 2U);
    }
}

TEST(PencilGrid, HitsNothingBeyondAnyFiniteLength) {
    Soup soup;
    soup.add({{0, 0, 1}, {1, 0, 1}, {0, 1, 1}});
    const Vec3 point{0.25F, 0.25F, 0};
    const auto yes = [](const Ray&) { return true; };
    for (const Pencil& pencil : {Pencil::parallel({0, 0, -1}), Pencil::radial({0, 0, 3})}) {
        const PencilGrid grid = build_pencil_grid(soup.view(), pencil);
        EXPECT_EQ(grid.occluded(point), Verdict::hit);
        for (const float far : {infinity, std::numeric_limits<float>::quiet_NaN()}) {
            EXPECT_EQ(grid.occluded(point, far), Verdict::miss);
            const std::vector<Vec3> points(40, point);
            const auto shadowed = std::make_unique<bool[]>(points.size());
            grid.occluded(points, far, {}, {shadowed.get(), points.size()}, yes);
            EXPECT_TRUE(
                std::none_of(shadowed.get(), shadowed.get() + points.size(), std::identity())
            );
        }
    }
    const PencilGrid grid = build_pencil_grid(soup.view(), Pencil::parallel({0, 0, -1}));
    const Ray endless{.origin = point, .direction = {0, 0, 1}, .t_min = infinity};
    ASSERT_TRUE(is_valid(endless) && grid.pencil().holds(endless));
    Hit hit;
    EXPECT_EQ(grid.any_hit(endless), Verdict::miss);
    EXPECT_EQ(grid.closest_hit(endless, hit), Verdict::miss);
}

/// Points in, on and around the mesh, and toward its vertices and edges.
void compare_on_mesh(const ClosedMesh& mesh, const Pencil& pencil, Rng& rng) {
    Soup soup;
    for (const auto& c : mesh.corners) {
        const auto at = [&](std::uint32_t i) { return to_float(mesh.vertices[i]); };
        soup.add({at(c[0]), at(c[1]), at(c[2])});
    }
    PencilGridParams params;
    params.bytes_per_triangle = 1e9;
    const PencilGrid grid = build_pencil_grid(soup.view(), pencil, params);
    Tally tally;
    for (int k = 0; k < 400 && !testing::Test::HasFatalFailure(); ++k) {
        const Ray ray = random_pencil_ray(rng, pencil, soup, Coordinates::smooth);
        if (is_valid(ray)) expect_same_as_brute_force(grid, soup.view(), ray, tally);
    }
}

TEST(PencilGrid, LeaksThroughNoClosedMesh) {
    Rng rng(16, 0);
    for (const ClosedMesh& mesh : {torus(24, 12), grid_box(6)}) {
        compare_on_mesh(mesh, Pencil::parallel({0.2F, -0.9F, 0.4F}), rng);
        compare_on_mesh(mesh, Pencil::parallel({0, 0, -1}), rng);
        compare_on_mesh(mesh, Pencil::parallel({1, 1, -1}), rng);
        compare_on_mesh(mesh, Pencil::radial({0, 0, 0}), rng);
        compare_on_mesh(mesh, Pencil::radial({0.9F, 0.1F, 0.05F}), rng);
        compare_on_mesh(mesh, Pencil::radial({1, 0, 0}), rng);
        compare_on_mesh(mesh, Pencil::radial({3, 4, -5}), rng);
        compare_on_mesh(mesh, Pencil::radial({1, 1, 7}), rng);
    }
}

/// A rolling ground of 2 * side * side triangles with a roof over a part of it.
Soup landscape(std::size_t side) {
    Soup soup;
    const auto at = [&](std::size_t i, std::size_t k) {
        const float x = static_cast<float>(i) / static_cast<float>(side);
        const float y = static_cast<float>(k) / static_cast<float>(side);
        return Vec3{x, 0.05F * std::sin(30 * x) * std::cos(20 * y), y};
    };
    for (std::size_t i = 0; i < side; ++i)
        for (std::size_t k = 0; k < side; ++k) {
            soup.add({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
            soup.add({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
        }
    for (const float height : {0.3F, 0.32F}) {
        soup.add({{0, height, 0}, {0.5F, height, 0}, {0.5F, height, 0.5F}});
        soup.add({{0, height, 0}, {0.5F, height, 0.5F}, {0, height, 0.5F}});
    }
    return soup;
}

TEST(PencilGrid, IsTheSameForAnyNumberOfThreads) {
    const Soup soup = landscape(120);
    const Executor two(2);
    for (const Pencil& pencil :
         {Pencil::parallel({0.2F, -1, 0.1F}), Pencil::radial({0.5F, 1, 0.5F})})
        EXPECT_EQ(
            build_pencil_grid(soup.view(), pencil).content_hash(),
            build_pencil_grid(soup.view(), pencil, {}, two).content_hash()
        );
}

TEST(PencilGrid, KeepsItsMemoryCapByCoarserCells) {
    Rng rng(17, 0);
    Soup soup; // long slivers everywhere
    for (int i = 0; i < 4000; ++i) {
        const Vec3 a = point(rng, Coordinates::smooth);
        const Vec3 b = point(rng, Coordinates::smooth);
        soup.add({a, b, b + Vec3{1e-3F, 1e-3F, 0}});
    }
    const Pencil pencil = Pencil::parallel({0.1F, 0.2F, -1});
    PencilGridParams params;
    params.cell_size = 1;
    const PencilGrid grid = build_pencil_grid(soup.view(), pencil, params);
    EXPECT_GT(grid.statistics().coarsened, 0U);
    EXPECT_LE(
        static_cast<double>(grid.size_in_bytes()),
        params.bytes_per_triangle * static_cast<double>(soup.corners.size()) + (1 << 17)
    );
    Tally tally;
    for (int k = 0; k < 200; ++k)
        expect_same_as_brute_force(
            grid, soup.view(), random_pencil_ray(rng, pencil, soup, Coordinates::smooth), tally
        );
}

TEST(PencilGrid, CullsWhatTwoTrianglesHideAndStillKnowsEveryShadow) {
    const Soup soup = landscape(100);
    const Pencil pencil = Pencil::parallel({0.1F, -1, 0.1F});
    const PencilGrid grid = build_pencil_grid(soup.view(), pencil);
    EXPECT_GT(grid.statistics().culled, soup.corners.size() / 10);
    Rng rng(18, 0);
    for (int k = 0; k < 2000; ++k) {
        PrimId prim = no_prim;
        const Vec3 p = surface_point(rng, soup, prim);
        const Ray ray = pencil.shadow_ray(p, rng.below(2) == 0 ? 1e-4F : 0, prim);
        const Verdict wanted = brute_force(soup.view(), ray).empty() ? Verdict::miss : Verdict::hit;
        ASSERT_EQ(grid.any_hit(ray), wanted);
        ASSERT_EQ(grid.occluded(p, ray.t_min, prim), wanted);
    }
}

/// Rays that a batch may answer together, and such that it may not.
enum class Together : std::uint8_t { shadows, views, anything };

std::vector<Ray>
batch_of(Together together, const Pencil& pencil, const Soup& soup, Coordinates how, Rng& rng) {
    std::vector<Ray> rays;
    for (int k = 0; k < 2000; ++k) {
        Ray ray = random_pencil_ray(rng, pencil, soup, how);
        PrimId prim = no_prim;
        const Vec3 place = surface_point(rng, soup, prim);
        if (together == Together::shadows) {
            ray = pencil.shadow_ray(ray.origin, ray.t_min, ray.excluded);
        } else if (together == Together::views) {
            ray.origin = pencil.kind() == Pencil::Kind::radial ? pencil.apex() : place;
            ray.direction =
                pencil.kind() == Pencil::Kind::radial ? place - ray.origin : pencil.direction();
            ray.t_min = 0;
        }
        if (is_valid(ray) && pencil.holds(ray)) rays.push_back(ray);
    }
    return rays;
}

void expect_batches_like_single_queries(const PencilGrid& grid, const std::vector<Ray>& rays) {
    const Executor two(2);
    const std::size_t count = rays.size();
    std::vector<Vec3> points;
    std::vector<PrimId> excluded;
    for (const Ray& ray : rays) {
        points.push_back(ray.origin);
        excluded.push_back(ray.excluded);
    }
    const auto any = std::make_unique<bool[]>(count);
    const auto shadowed = std::make_unique<bool[]>(count);
    std::vector<Hit> closest(count);
    const auto yes = [](const Ray&) { return true; };
    const Hit marked{.prim = PrimId{77}};
    grid.any_hits(rays, {any.get(), count}, yes, two);
    grid.closest_hits(rays, closest, [&](const Ray&) { return marked; }, two);
    grid.occluded(points, 1e-4F, excluded, {shadowed.get(), count}, yes, two);
    for (std::size_t i = 0; i < count; ++i) {
        ASSERT_EQ(any[i], grid.any_hit(rays[i]) != Verdict::miss);
        ASSERT_EQ(shadowed[i], grid.occluded(points[i], 1e-4F, excluded[i]) != Verdict::miss);
        Hit hit;
        const Verdict verdict = grid.closest_hit(rays[i], hit);
        if (verdict == Verdict::unknown) hit = marked;
        if (verdict == Verdict::miss) hit = Hit{};
        ASSERT_EQ(closest[i].prim, hit.prim);
        ASSERT_EQ(closest[i].t, hit.t);
        ASSERT_EQ(closest[i].u, hit.u);
        ASSERT_EQ(closest[i].v, hit.v);
        ASSERT_EQ(closest[i].front, hit.front);
    }
}

TEST(PencilGrid, BatchesAnswerAsSingleQueriesDoOnEveryInstructionSet) {
    for (int i = 0; i < 20 && !testing::Test::HasFatalFailure(); ++i) {
        Rng rng(19, static_cast<std::uint64_t>(i));
        const auto how = i % 2 == 0 ? Coordinates::smooth : Coordinates::grid;
        const Soup soup = i < 2 ? landscape(60) : random_soup(rng, 400, how);
        const Pencil pencil = random_pencil(rng, soup, how);
        PencilGrid grid = build_pencil_grid(soup.view(), pencil);
        for (const std::string_view set : PencilGrid::instruction_sets()) {
            grid.use_instruction_set(set);
            for (const Together together :
                 {Together::shadows, Together::views, Together::anything}) {
                SCOPED_TRACE(testing::Message() << "soup " << i << ", " << set);
                expect_batches_like_single_queries(
                    grid, batch_of(together, pencil, soup, how, rng)
                );
            }
        }
    }
}

TEST(PencilGrid, FewShadowRaysOfADenseMeshLookAtATriangle) {
    const Soup soup = landscape(200);
    const Pencil pencil = Pencil::parallel({0.3F, -1, 0.1F});
    const PencilGrid grid = build_pencil_grid(soup.view(), pencil);
    Rng rng(20, 0);
    PencilGridCounts counts;
    for (int k = 0; k < 10000; ++k) {
        PrimId prim = no_prim;
        const Vec3 p = surface_point(rng, soup, prim);
        static_cast<void>(grid.any_hit(pencil.shadow_ray(p, 1e-4F, prim), counts));
    }
    EXPECT_LT(counts.prims, counts.queries / 5);
}

TEST(PencilGrid, RefusesParametersOutOfRange) {
    const Soup soup = landscape(2);
    const Pencil pencil = Pencil::parallel({0, -1, 0});
    EXPECT_THROW(
        static_cast<void>(build_pencil_grid(soup.view(), pencil, {.cell_size = 0.5})), Error
    );
    EXPECT_THROW(
        static_cast<void>(build_pencil_grid(soup.view(), pencil, {.leaf_size = 3})), Error
    );
    EXPECT_THROW(
        static_cast<void>(build_pencil_grid(soup.view(), pencil, {.bytes_per_triangle = 63})), Error
    );
    PencilGrid grid = build_pencil_grid(soup.view(), pencil);
    EXPECT_THROW(grid.use_instruction_set("abacus"), Error);
}

} // namespace
} // namespace raywise
