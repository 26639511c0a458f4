#include <raywise/trace/wide.hpp>

#include "support/closed_mesh.hpp"
#include "support/median_split.hpp"
#include "support/simd_target.hpp"
#include "support/soup.hpp"
#include "support/wide_tree.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/trace/all_hits.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raywise {
namespace {

using namespace test_support;

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Every test runs on every instruction set of this machine.
class Wide : public OnSimdTarget {};

INSTANTIATE_TEST_SUITE_P(Targets, Wide, testing::ValuesIn(simd_targets()), name_of_target);

void expect_same(const std::optional<Hit>& hit, const std::optional<Hit>& expected) {
    ASSERT_EQ(hit.has_value(), expected.has_value());
    if (!hit) return;
    ASSERT_EQ(hit->t, expected->t);
    ASSERT_EQ(hit->prim, expected->prim);
    ASSERT_EQ(hit->u, expected->u);
    ASSERT_EQ(hit->v, expected->v);
    ASSERT_EQ(hit->front, expected->front);
}

TEST_P(Wide, EmptyTreeIsNeverHitAndNothingIsTested) {
    const Ray ray{{0, 0, 5}, {0, 0, -1}};
    Counts counts;
    EXPECT_EQ(closest_hit(WideBvh{}, ray, counts), std::nullopt);
    EXPECT_FALSE(any_hit(WideBvh{}, ray, counts));
    EXPECT_EQ(counts, Counts{});
}

TEST_P(Wide, InvalidRaysVisitNothing) {
    Soup soup;
    soup.add({{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}});
    const WideBvh tree = wide_tree(soup.view());
    for (const Ray& ray :
         {Ray{{nan, 0, 0}, {0, 0, 1}},
          Ray{{0, 0, 0}, {0, 0, nan}},
          Ray{{0, 0, 0}, {0, -0.0F, 0}},
          Ray{{infinity, 0, 0}, {0, 0, 1}},
          Ray{{0, 0, 0}, {0, 0, infinity}},
          Ray{{0, 0, 0}, {0, 0, 1}, 2, 1},
          Ray{{0, 0, 0}, {0, 0, 1}, nan, 1},
          Ray{{0, 0, 0}, {0, 0, 1}, -1, 1}}) {
        Counts counts;
        EXPECT_EQ(closest_hit(tree, ray, counts), std::nullopt);
        EXPECT_FALSE(any_hit(tree, ray, counts));
        EXPECT_EQ(counts, Counts{});
        std::array<Hit, 1> hits;
        closest_hits(tree, std::array{ray}, hits);
        EXPECT_EQ(hits[0].prim, no_prim);
    }
}

TEST_P(Wide, EqualDistancesGoToTheLowestId) {
    Soup soup;
    for (int i = 0; i < 40; ++i)
        soup.add({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    for (std::size_t leaf_size = 1; leaf_size < 10; ++leaf_size) {
        const WideBvh tree = wide_tree(soup.view(), leaf_size, 1 + leaf_size % 3);
        Ray ray{{0.25F, 0.25F, 5}, {0, 0, -1}};
        for (std::uint32_t i = 0; i < 2; ++i) {
            const auto hit = closest_hit(tree, ray);
            ASSERT_TRUE(hit);
            EXPECT_EQ(hit->prim, PrimId{i});
            ray.excluded = hit->prim;
        }
        ray.t_min = ray.t_max = 5;
        EXPECT_TRUE(any_hit(tree, ray));
        EXPECT_EQ(closest_hit(tree, ray)->prim, PrimId{0});
    }
}

/// More triangles in doubt than a query notes for later.
TEST_P(Wide, FansAroundOneVertexAreHitThere) {
    constexpr int count = 60;
    const Vec3 top{0.1F, 0.2F, 0.3F};
    const auto rim = [](int i) {
        const float angle = 6.2831853F * static_cast<float>(i % count) / count;
        return Vec3{std::cos(angle), std::sin(angle), -1};
    };
    Soup soup;
    for (int i = 0; i < count; ++i)
        soup.add({rim(i), rim(i + 1), top});
    Rng rng(26);
    for (std::size_t leaf_size = 1; leaf_size < 10; leaf_size += 3) {
        const WideBvh tree = wide_tree(soup.view(), leaf_size);
        for (int i = 0; i < 300; ++i) {
            const auto coordinate = [&] { return 2 * rng.uniform() - 1; };
            Ray ray{{coordinate(), coordinate(), 3}, {}};
            ray.direction = top - ray.origin;
            if (i % 2 == 0) ray = {{top.x, top.y, coordinate() + 2}, {0, 0, -1}};
            const auto expected = brute_force_closest_hit(soup.view(), ray);
            expect_same(closest_hit(tree, ray), expected);
            ASSERT_EQ(any_hit(tree, ray), expected.has_value());
            if (i % 2 == 0) {
                // Every triangle of the fan, and the first of them that is not excluded.
                ASSERT_EQ(brute_force_all_hits(soup.view(), ray).size(), count);
                ray.excluded = PrimId{0};
                EXPECT_EQ(closest_hit(tree, ray)->prim, PrimId{1});
                ray.t_min = ray.t_max = expected->t;
                EXPECT_EQ(closest_hit(tree, ray)->prim, PrimId{1});
                EXPECT_TRUE(any_hit(tree, ray));
            }
        }
    }
}

/// Each coordinate times `scale`, vertices and origins; t is unchanged.
Soup scaled(const Soup& soup, float scale) {
    Soup out = soup;
    for (Vec3& vertex : out.vertices)
        vertex = vertex * scale;
    return out;
}

TEST_P(Wide, AgreesWithBruteForceOnSoups) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 1500; ++i) {
        Rng rng(21, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 64, how);
        const TriangleView view = soup.view();
        const WideBvh tree = wide_tree(view, 1 + i % 9, 1 + i % 2);
        for (int k = 0; k < 20; ++k) {
            const Ray ray = random_ray(rng, soup, how);
            const std::vector<Hit> all = brute_force_all_hits(view, ray);
            const std::optional<Hit> expected =
                all.empty() ? std::nullopt : std::optional(all.front());
            expect_same(closest_hit(tree, ray), expected);
            ASSERT_EQ(any_hit(tree, ray), expected.has_value()) << i << ' ' << k;
            std::vector<Hit> found;
            all_hits(tree, ray, [&](const Hit& hit) { found.push_back(hit); });
            sort_hits(found);
            ASSERT_EQ(found.size(), all.size());
            for (std::size_t j = 0; j < all.size(); ++j)
                expect_same(found[j], all[j]);
            if (HasFatalFailure()) FAIL() << i << ' ' << k;
            hits += static_cast<int>(all.size());
        }
    }
    EXPECT_GT(hits, 10000);
}

TEST_P(Wide, AgreesWithBruteForceAtAnyScale) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 600; ++i) {
        Rng rng(22, i);
        const Soup unit = random_soup(rng, 32, Coordinates::smooth);
        const float scale = std::exp2(static_cast<float>(rng.below(110)) - 60);
        const float stretch = std::exp2(static_cast<float>(rng.below(100)) - 50);
        const Soup soup = scaled(unit, scale);
        const WideBvh tree = wide_tree(soup.view());
        for (int k = 0; k < 20; ++k) {
            Ray ray = random_ray(rng, unit, Coordinates::smooth);
            ray.origin = ray.origin * scale;
            ray.direction = ray.direction * (scale * stretch);
            // Now and then a direction whose components differ as much as floats allow.
            if (rng.below(4) == 0)
                ray.direction[static_cast<int>(rng.below(3))] *=
                    std::exp2(-static_cast<float>(rng.below(60)));
            if (!is_valid(ray)) continue;
            const auto expected = brute_force_closest_hit(soup.view(), ray);
            expect_same(closest_hit(tree, ray), expected);
            ASSERT_EQ(any_hit(tree, ray), expected.has_value());
            if (HasFatalFailure()) FAIL() << i << ' ' << k;
            if (expected) ++hits;
        }
    }
    EXPECT_GT(hits, 1000);
}

/// Any frame answers any ray: those along it, nearly along it, and all others.
TEST_P(Wide, FramedTreesAgreeWithBruteForce) {
    int hits = 0;
    for (std::uint64_t i = 0; i < 600; ++i) {
        Rng rng(25, i);
        const auto how = static_cast<Coordinates>(rng.below(4));
        const Soup soup = random_soup(rng, 64, how);
        const auto slope = [&] { return 2 * static_cast<double>(rng.uniform()) - 1; };
        const Vec3d direction{slope(), slope(), slope()};
        const WideBvh tree = framed_tree(soup.view(), box_frame_along(direction), 1 + i % 4);
        for (int k = 0; k < 30; ++k) {
            Ray ray = random_ray(rng, soup, how);
            if (k % 3 != 0) {
                ray.direction = to_float(direction);
                if (k % 3 == 1) {
                    const double size = std::exp2(-static_cast<double>(rng.below(30)));
                    ray.direction =
                        to_float(direction + Vec3d{slope() * size, slope() * size, slope() * size});
                }
                // Through a vertex, about.
                const Vec3 goal =
                    soup.vertices[static_cast<std::size_t>(rng.below(soup.vertices.size()))];
                ray.origin = goal - ray.direction * (4 * rng.uniform());
            }
            if (!is_valid(ray)) continue;
            const auto expected = brute_force_closest_hit(soup.view(), ray);
            expect_same(closest_hit(tree, ray), expected);
            ASSERT_EQ(any_hit(tree, ray), expected.has_value());
            if (HasFatalFailure()) FAIL() << i << ' ' << k;
            if (expected) ++hits;
        }
    }
    EXPECT_GT(hits, 2000);
}

TEST_P(Wide, RaysAlongTheAxesInTheFacesOfBoxesAreNotLost) {
    const ClosedMesh mesh = grid_box(4);
    std::vector<Vec3> vertices;
    for (const Vec3d& vertex : mesh.vertices)
        vertices.push_back(to_float(vertex));
    const TriangleView view(vertices, mesh.corners);
    const WideBvh tree = wide_tree(view, 1, 1);
    for (const Vec3& from : vertices)
        for (int axis = 0; axis < 3; ++axis)
            for (const float side : {-1.0F, 1.0F})
                for (const float other : {0.0F, -0.0F, 0x1p-30F, -0x1p-149F}) {
                    Ray ray;
                    ray.origin = from;
                    ray.origin[axis] = -3 * side;
                    ray.direction = {other, other, other};
                    ray.direction[axis] = side;
                    const auto expected = brute_force_closest_hit(view, ray);
                    expect_same(closest_hit(tree, ray), expected);
                    ASSERT_EQ(any_hit(tree, ray), expected.has_value());
                }
}

TEST_P(Wide, ClosedMeshesLeakNothing) {
    for (const ClosedMesh& mesh : {icosphere(4), torus(40, 20), grid_box(12)}) {
        for (const double scale : {1e-6, 1.0, 3e5}) {
            std::vector<Vec3> vertices;
            for (const Vec3d& vertex : mesh.vertices)
                vertices.push_back(to_float(vertex * scale));
            const TriangleView view(vertices, mesh.corners);
            const WideBvh tree = wide_tree(view);
            Rng rng(23);
            const auto vertex = [&] {
                return vertices[static_cast<std::size_t>(rng.below(vertices.size()))];
            };
            for (int i = 0; i < 3000; ++i) {
                // From inside the tube of the torus or near the center of the others, toward a
                // vertex, the middle of an edge, or anywhere.
                Ray ray;
                const bool is_torus = vertices.size() == 800;
                ray.origin = is_torus ? Vec3{static_cast<float>(scale), 0, 0} : Vec3{};
                const auto& corner =
                    mesh.corners[static_cast<std::size_t>(rng.below(mesh.corners.size()))];
                const Vec3 a = vertices[corner[0]];
                const Vec3 b = vertices[corner[1]];
                const float share = rng.below(2) == 0 ? 0.5F : rng.uniform();
                const Vec3 goal = rng.below(3) == 0 ? vertex() : a + (b - a) * share;
                ray.direction = goal - ray.origin;
                if (!is_valid(ray)) continue;
                ASSERT_TRUE(any_hit(tree, ray)) << i;
                ASSERT_TRUE(closest_hit(tree, ray)) << i;
            }
        }
    }
}

/// Real size: many triangles, against the binary tree, whose answers are those of brute force.
TEST_P(Wide, AgreesWithTheBinaryTreeOnManyTriangles) {
    Rng rng(24);
    Soup soup;
    for (int i = 0; i < 20000; ++i) {
        const auto coordinate = [&] { return 100 * rng.uniform(); };
        const Vec3 at{coordinate(), coordinate(), coordinate()};
        const auto near = [&] {
            return at + Vec3{rng.uniform(), rng.uniform(), rng.uniform()} * 3.0F;
        };
        soup.add({at, near(), near()});
    }
    const Bvh binary = median_split(soup.view(), 3);
    const IndexedTriangles triangles(soup.view());
    const WideBvh tree = wide_tree(soup.view(), 3);
    std::vector<Ray> rays;
    for (int i = 0; i < 20000; ++i) {
        const auto coordinate = [&] { return 120 * rng.uniform() - 10; };
        Ray ray{{coordinate(), coordinate(), coordinate()}, {}};
        ray.direction = Vec3{coordinate(), coordinate(), coordinate()} - ray.origin;
        if (rng.below(3) == 0) ray.t_max = rng.uniform();
        rays.push_back(ray);
    }
    std::vector<Hit> hits(rays.size());
    closest_hits(tree, rays, hits, Executor(3));
    const auto occluded = std::make_unique<bool[]>(rays.size());
    any_hits(tree, rays, {occluded.get(), rays.size()}, Executor(3));
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto expected = closest_hit(binary, triangles, rays[i]);
        expect_same(closest_hit(tree, rays[i]), expected);
        ASSERT_EQ(hits[i].prim, expected ? expected->prim : no_prim);
        ASSERT_EQ(hits[i].t, expected ? expected->t : infinity);
        ASSERT_EQ(occluded[i], expected.has_value());
        // Away from edges the fast mode agrees up to its rounding.
        const auto fast = closest_hit(tree, rays[i], TraceMode::fast);
        if (expected && expected->u > 1e-3F && expected->v > 1e-3F &&
            expected->u + expected->v < 1 - 1e-3F && expected->t < 0.999F * rays[i].t_max) {
            ASSERT_TRUE(fast);
            ASSERT_LE(fast->t, expected->t * (1 + 1e-4F));
            ASSERT_TRUE(any_hit(tree, rays[i], TraceMode::fast));
            if (fast->prim == expected->prim) {
                ASSERT_NEAR(fast->u, expected->u, 1e-3F);
                ASSERT_NEAR(fast->v, expected->v, 1e-3F);
                ASSERT_EQ(fast->front, expected->front);
            }
        }
    }
}

TEST(WideBatches, RefuseArraysOfOtherSizes) {
    const std::array<Ray, 2> rays{};
    std::array<Hit, 1> hits;
    std::array<bool, 3> occluded{};
    EXPECT_THROW(closest_hits(WideBvh{}, rays, hits), Error);
    EXPECT_THROW(any_hits(WideBvh{}, rays, occluded), Error);
}

TEST(SimdTargets, UnknownNamesAreRefused) {
    EXPECT_FALSE(simd_targets().empty());
    EXPECT_THROW(force_simd_target("abacus"), Error);
}

} // namespace
} // namespace raywise
