#include <raywise/toplevel/accelerator.hpp>

#include "support/random_areas.hpp"

#include <raywise/core/error.hpp>
#include <raywise/trace/all_hits.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/brute_force.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>

namespace raywise {
namespace {

using test_support::random_areas;
using test_support::random_ray;
using test_support::random_soup;
using test_support::soup_of;

/// The oracle: one plain tree over everything.
struct PlainTree {
    explicit PlainTree(const Scene& scene)
        : tree(build_tree(build_input_of(scene.view()), surface_area_heuristic()).tree)
        , triangles(tree, scene.view()) {}

    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const {
        return raywise::closest_hit(tree, triangles, ray);
    }

    Bvh tree;
    PackedTriangles triangles;
};

bool is_same(const std::optional<Hit>& a, const std::optional<Hit>& b) {
    if (a.has_value() != b.has_value()) return false;
    return !a || (a->t == b->t && a->prim == b->prim && a->u == b->u && a->v == b->v &&
                  a->front == b->front);
}

/// An area in which every ray that starts inside is affine.
InfluenceArea open_area(std::string name, const Region& region) {
    return {
        .name = std::move(name),
        .region = region,
        .distribution = ParallelDistribution({.point = {0, 0, 0}, .frame = frame_along({0, 0, 1})}),
        .affinity = {.angle_deg = 90}
    };
}

AcceleratorParams random_params(Rng& rng) {
    AcceleratorParams params = two_binary_levels();
    params.max_candidates = std::array{1, 2, 8}[rng.below(3)];
    params.index.kind = std::array{
        RegionIndexKind::list, RegionIndexKind::octree, RegionIndexKind::bvh
    }[rng.below(3)];
    params.index.octree.max_level = 3;
    if (rng.below(2) == 0) params.index.octree.mode = OctreeMode::under;
    params.local.measure =
        std::array{MeasureKind::surface, MeasureKind::area, MeasureKind::mixed}[rng.below(3)];
    params.membership.margin = rng.below(2) == 0 ? 1e-4 : 1e-6;
    return params;
}

TEST(Accelerator, AgreesWithOnePlainTreeForEveryRay) {
    std::size_t local_answers = 0;
    std::size_t hits = 0;
    std::size_t rays = 0;
    for (std::uint64_t seed = 0; seed < 150; ++seed) {
        Rng rng(31, seed);
        const Scene scene = random_soup(rng, 1 + rng.below(rng.below(2) == 0 ? 20 : 400));
        const auto areas = random_areas(rng, rng.below(7));
        const Accelerator accelerator = build_accelerator(scene, areas, random_params(rng));
        const PlainTree plain(scene);
        for (int i = 0; i < 400; ++i) {
            const Ray ray = random_ray(rng, scene, areas);
            const auto expected = plain.closest_hit(ray);
            Served served;
            ASSERT_TRUE(is_same(accelerator.closest_hit(ray, served), expected))
                << "seed " << seed << " ray " << i;
            ASSERT_TRUE(is_same(accelerator.closest_hit(ray), expected));
            ASSERT_EQ(accelerator.any_hit(ray), expected.has_value())
                << "seed " << seed << " ray " << i;
            if (!areas.empty()) {
                const AreaHandle handle = accelerator[to_area(rng.below(areas.size()))];
                ASSERT_TRUE(is_same(handle.closest_hit(ray), expected));
                ASSERT_EQ(handle.any_hit(ray), expected.has_value());
            }
            ++rays;
            hits += expected ? 1U : 0U;
            local_answers += served.went_global() ? 0U : 1U;
        }
    }
    // The test is about something: rays hit and miss, areas answer and do not.
    EXPECT_GT(hits, rays / 5);
    EXPECT_LT(hits, rays);
    EXPECT_GT(local_answers, rays / 50);
    EXPECT_LT(local_answers, rays);
}

TEST(Accelerator, AgreesWithBruteForceOnAllHits) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Rng rng(32, seed);
        const Scene scene = random_soup(rng, 40);
        const auto areas = random_areas(rng, 4);
        const Accelerator accelerator = build_accelerator(scene, areas, random_params(rng));
        for (int i = 0; i < 200; ++i) {
            const Ray ray = random_ray(rng, scene, areas);
            const auto expected = brute_force_all_hits(scene.view(), ray);
            std::vector<Hit> found;
            accelerator.all_hits(ray, [&](const Hit& hit) { found.push_back(hit); });
            std::sort(found.begin(), found.end(), is_closer);
            ASSERT_EQ(found.size(), expected.size()) << "seed " << seed << " ray " << i;
            for (std::size_t k = 0; k < found.size(); ++k) {
                ASSERT_EQ(found[k].prim, expected[k].prim);
                ASSERT_EQ(found[k].t, expected[k].t);
            }
            const auto closest = accelerator.closest_hit(ray);
            ASSERT_EQ(closest.has_value(), !expected.empty());
            if (closest) {
                ASSERT_EQ(closest->prim, expected.front().prim);
            }
        }
    }
}

TEST(Accelerator, AgreesAtAnyScale) {
    for (std::uint64_t seed = 0; seed < 60; ++seed) {
        Rng rng(33, seed);
        Scene scene = random_soup(rng, 60);
        auto areas = random_areas(rng, 4);
        const auto scale = static_cast<float>(std::exp2(rng.uniform(-60, 50)));
        const auto grow = [&](Vec3d v) { return v * static_cast<double>(scale); };
        for (Vec3& vertex : scene.vertices)
            vertex = vertex * scale;
        for (InfluenceArea& area : areas) {
            if (auto* box = std::get_if<Aabb>(&area.region)) {
                *box = {box->lo * scale, box->hi * scale};
            } else if (auto* obb = std::get_if<Obb>(&area.region)) {
                *obb = {grow(obb->center), obb->frame, grow(obb->half)};
            } else if (auto* frustum = std::get_if<Frustum>(&area.region)) {
                frustum->eye = grow(frustum->eye);
                frustum->near *= static_cast<double>(scale);
                frustum->far *= static_cast<double>(scale);
            }
            area.affinity.angle_deg = 90;
        }
        const Accelerator accelerator = build_accelerator(scene, areas, two_binary_levels());
        const PlainTree plain(scene);
        for (int i = 0; i < 200; ++i) {
            Ray ray = random_ray(rng, scene, areas);
            ray.t_min = ray.t_min * scale;
            ray.t_max = ray.t_max * scale;
            ASSERT_TRUE(is_same(accelerator.closest_hit(ray), plain.closest_hit(ray)))
                << "seed " << seed << " ray " << i;
        }
    }
}

// The three ways in which "a hit in the local tree is the closest" is false (method, section 5.3).

TEST(AcceleratorAgainstTheThesis, APartlyInsideTriangleHidesBehindAnOutsideOne) {
    // The leaning triangle 0 starts inside and is hit by a
    // ray along +y at y = 10; triangle 1 at y = 5 is outside altogether.
    const Scene scene =
        soup_of({{{0, 0, -1}, {0, 0, 1}, {4, 20, 0}}, {{-9, 5, -9}, {9, 5, -9}, {0, 5, 9}}});
    const Region region = Aabb{{-1, -1, -1}, {3, 1, 1}};
    const Ray ray{.origin = {2, 0, 0}, .direction = {0, 1, 0}};
    const Accelerator exact =
        build_accelerator(scene, {open_area("slab", region)}, two_binary_levels());
    Served served;
    const auto hit = exact.closest_hit(ray, served);
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->prim, PrimId{1});
    EXPECT_EQ(hit->t, 5);
    ASSERT_EQ(served.searches().size(), 2U);
    // The local hit bounds what is left for the global tree.
    EXPECT_LE(served.searches()[1].begin, 1);
    EXPECT_GT(served.searches()[1].begin, 0.999F);
    EXPECT_EQ(served.searches()[1].end, 10);
    EXPECT_EQ(served.answered(), &served.searches()[1]);

    AcceleratorParams thesis = two_binary_levels();
    thesis.mode = QueryMode::first_hit_wins;
    const Accelerator wrong = build_accelerator(scene, {open_area("slab", region)}, thesis);
    ASSERT_TRUE(wrong.closest_hit(ray));
    EXPECT_EQ(wrong.closest_hit(ray)->prim, PrimId{0});
}

TEST(AcceleratorAgainstTheThesis, AWallWithoutAVertexInsideIsLost) {
    const Scene scene =
        soup_of({{{-50, -50, 1}, {50, -50, 1}, {0, 90, 1}}, {{-1, -1, 2}, {1, -1, 2}, {0, 1, 2}}});
    const Region region = Aabb{{-3, -3, -3}, {3, 3, 3}};
    const Ray ray{.origin = {0, 0, 0}, .direction = {0, 0, 1}};
    const Accelerator exact =
        build_accelerator(scene, {open_area("room", region)}, two_binary_levels());
    ASSERT_TRUE(exact.closest_hit(ray));
    EXPECT_EQ(exact.closest_hit(ray)->prim, PrimId{0});

    AcceleratorParams thesis = two_binary_levels();
    thesis.mode = QueryMode::first_hit_wins;
    thesis.membership.rule = Membership::vertices;
    const Accelerator wrong = build_accelerator(scene, {open_area("room", region)}, thesis);
    ASSERT_TRUE(wrong.closest_hit(ray));
    EXPECT_EQ(wrong.closest_hit(ray)->prim, PrimId{1});
}

TEST(AcceleratorAgainstTheThesis, WithSeveralAreasTheFirstHitIsNotTheClosest) {
    // Both regions hold the origin; the flat one sees the leaning triangle 0 far beyond its exit,
    // the tall one holds triangle 1 in front of it.
    const Scene scene =
        soup_of({{{0, 0, -1}, {0, 0, 1}, {4, 20, 0}}, {{-9, 5, -9}, {9, 5, -9}, {0, 5, 9}}});
    const std::vector areas{
        open_area("flat", Aabb{{-1, -1, -1}, {3, 1, 1}}),
        open_area("tall", Aabb{{-1, -1, -1}, {3, 8, 1}})
    };
    const Ray ray{.origin = {2, 0, 0}, .direction = {0, 1, 0}};
    for (const int candidates : {1, 2}) {
        AcceleratorParams params = two_binary_levels();
        params.max_candidates = candidates;
        Served served;
        const auto hit = build_accelerator(scene, areas, params).closest_hit(ray, served);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->prim, PrimId{1});
        EXPECT_FALSE(served.went_global()); // the tall area proves it
    }
    AcceleratorParams thesis = two_binary_levels();
    thesis.mode = QueryMode::first_hit_wins;
    EXPECT_EQ(build_accelerator(scene, areas, thesis).closest_hit(ray)->prim, PrimId{0});
}

TEST(AcceleratorAgainstTheThesis, TheFirstHitRuleIsOftenWrongAndTheExactOneNever) {
    std::size_t wrong = 0;
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
        Rng rng(34, seed);
        const Scene scene = random_soup(rng, 400);
        const auto areas = random_areas(rng, 3);
        AcceleratorParams thesis = two_binary_levels();
        thesis.mode = QueryMode::first_hit_wins;
        thesis.membership.rule = Membership::vertices;
        const Accelerator faithful = build_accelerator(scene, areas, thesis);
        const Accelerator exact = build_accelerator(scene, areas, two_binary_levels());
        for (int i = 0; i < 200; ++i) {
            const Ray ray = random_ray(rng, scene, areas);
            const auto expected = brute_force_closest_hit(scene.view(), ray);
            ASSERT_TRUE(is_same(exact.closest_hit(ray), expected));
            wrong += is_same(faithful.closest_hit(ray), expected) ? 0U : 1U;
        }
    }
    EXPECT_GT(wrong, 10U);
}

TEST(Accelerator, EndsInsideAreAnsweredLocally) {
    const Scene scene = soup_of({{{-9, 5, -9}, {9, 5, -9}, {0, 5, 9}}});
    const Region region = Aabb{{-1, -1, -1}, {1, 2, 1}};
    const Accelerator accelerator =
        build_accelerator(scene, {open_area("room", region)}, two_binary_levels());
    EXPECT_TRUE(accelerator.local(AreaId{0}).tree.binary()->tree.is_empty());
    const Ray shadow{.origin = {0, 0, 0}, .direction = {0, 1, 0}, .t_max = 1.5F};
    Served served;
    EXPECT_FALSE(accelerator.any_hit(shadow, served));
    EXPECT_FALSE(served.went_global());
    EXPECT_EQ(served.searches().size(), 1U);
    EXPECT_EQ(served.total().prims, 0U); // an empty local set proves the interval for nothing

    Ray longer = shadow;
    longer.t_max = 6;
    Served continued;
    EXPECT_TRUE(accelerator.any_hit(longer, continued));
    EXPECT_TRUE(continued.went_global());
    EXPECT_GT(continued.searches()[1].begin, 1.9F);
    EXPECT_EQ(continued.searches()[1].end, 6);
}

TEST(Accelerator, ALocalOccluderBeyondTheExitIsEnoughForAnyHit) {
    const Scene scene = soup_of({{{0, 0, -1}, {0, 0, 1}, {4, 20, 0}}});
    const Accelerator accelerator = build_accelerator(
        scene, {open_area("slab", Aabb{{-1, -1, -1}, {3, 1, 1}})}, two_binary_levels()
    );
    Served served;
    EXPECT_TRUE(accelerator.any_hit({.origin = {2, 0, 0}, .direction = {0, 1, 0}}, served));
    EXPECT_FALSE(served.went_global());
}

TEST(Accelerator, TiesBetweenTreesGoToTheLowestId) {
    // The same triangle three times; the region holds all, the ray ties between them.
    const Triangle wall{{-9, 5, -9}, {9, 5, -9}, {0, 5, 9}};
    const Scene scene = soup_of({wall, wall, wall});
    const Accelerator accelerator = build_accelerator(
        scene,
        {open_area("a", Aabb{{-1, -1, -1}, {1, 5, 1}}), open_area("b", Aabb{{-1, 0, -1}, {1, 9, 1}})
        },
        two_binary_levels()
    );
    Ray ray{.origin = {0, 0, 0}, .direction = {0, 1, 0}};
    EXPECT_EQ(accelerator.closest_hit(ray)->prim, PrimId{0});
    ray.excluded = PrimId{0};
    EXPECT_EQ(accelerator.closest_hit(ray)->prim, PrimId{1});
    ray.t_min = 5;
    ray.t_max = 5;
    EXPECT_EQ(accelerator.closest_hit(ray)->prim, PrimId{1});
}

TEST(Accelerator, NonAffineRaysAndOutsidersGoToTheGlobalTreeAlone) {
    Rng rng(35);
    const Scene scene = random_soup(rng, 50);
    InfluenceArea area = open_area("sun", Aabb{{-2, -2, -2}, {2, 2, 2}});
    area.affinity.angle_deg = 5;
    const Accelerator accelerator = build_accelerator(scene, {area}, two_binary_levels());
    const auto searched = [&](const Ray& ray) {
        Served served;
        static_cast<void>(accelerator.closest_hit(ray, served));
        return served.searches().front().area.has_value();
    };
    EXPECT_TRUE(searched({.origin = {0, 0, 0}, .direction = {0, 0, 1}}));
    EXPECT_TRUE(searched({.origin = {0, 0, 0}, .direction = {0, 0, -3}}));
    EXPECT_TRUE(searched({.origin = {2, 2, 2}, .direction = {0, 0, -1}})); // on the border
    EXPECT_FALSE(searched({.origin = {0, 0, 0}, .direction = {1, 0, 1}}));
    EXPECT_FALSE(searched({.origin = {0, 0, 2.001F}, .direction = {0, 0, -1}}));
}

TEST(Accelerator, InvalidRaysMissAndVisitNothing) {
    Rng rng(36);
    const Scene scene = random_soup(rng, 50);
    const Accelerator accelerator = build_accelerator(
        scene, {open_area("all", Aabb{{-9, -9, -9}, {9, 9, 9}})}, two_binary_levels()
    );
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    const std::vector<Ray> rays{
        {.origin = {nan, 0, 0}, .direction = {0, 0, 1}},
        {.origin = {0, 0, 0}, .direction = {0, nan, 1}},
        {.origin = {0, 0, 0}, .direction = {0, 0, 0}},
        {.origin = {infinity, 0, 0}, .direction = {0, 0, 1}},
        {.origin = {0, 0, 0}, .direction = {0, 0, 1}, .t_min = 2, .t_max = 1},
        {.origin = {0, 0, 0}, .direction = {0, 0, 1}, .t_min = nan}
    };
    for (const Ray& ray : rays) {
        Served served;
        EXPECT_FALSE(accelerator.closest_hit(ray, served));
        EXPECT_FALSE(accelerator.any_hit(ray, served));
        EXPECT_FALSE(accelerator["all"].any_hit(ray, served));
        EXPECT_TRUE(served.searches().empty());
        accelerator.all_hits(ray, [](const Hit&) { ADD_FAILURE(); });
    }
}

TEST(Accelerator, OverNoTrianglesEveryRayMisses) {
    const Accelerator accelerator =
        build_accelerator(Scene{}, {open_area("all", Aabb{{-9, -9, -9}, {9, 9, 9}})});
    EXPECT_FALSE(accelerator.closest_hit({.origin = {0, 0, 0}, .direction = {0, 0, 1}}));
    EXPECT_FALSE(accelerator.any_hit({.origin = {0, 0, 0}, .direction = {0, 0, 1}}));
}

TEST(Accelerator, BatchesEqualSingleQueriesOnAnyNumberOfThreads) {
    Rng rng(37);
    const Scene scene = random_soup(rng, 200);
    const auto areas = random_areas(rng, 4);
    const Executor four(4);
    const Accelerator accelerator = build_accelerator(scene, areas, two_binary_levels(), four);
    std::vector<Ray> rays;
    for (int i = 0; i < 3000; ++i)
        rays.push_back(random_ray(rng, scene, areas));
    rays.push_back({.origin = {0, 0, 0}, .direction = {0, 0, 0}});
    std::vector<Hit> hits(rays.size());
    std::vector<Hit> local(rays.size());
    const auto any = std::make_unique<bool[]>(rays.size());
    accelerator.closest_hits(rays, hits, four);
    accelerator[AreaId{1}].closest_hits(rays, local, four);
    accelerator.any_hits(rays, {any.get(), rays.size()}, four);
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const auto expected = accelerator.closest_hit(rays[i]);
        ASSERT_EQ(hits[i].prim, expected ? expected->prim : no_prim);
        ASSERT_EQ(hits[i].t, expected.value_or(Hit{}).t);
        ASSERT_EQ(local[i].prim, hits[i].prim);
        ASSERT_EQ(any[i], expected.has_value());
    }
    EXPECT_THROW(accelerator.closest_hits(rays, std::span(hits).first(1)), Error);
    EXPECT_THROW(accelerator.any_hits(rays, {any.get(), 1}), Error);
}

TEST(Accelerator, IsTheSameForAnyNumberOfThreads) {
    Rng rng(38);
    const Scene scene = random_soup(rng, 5000);
    const auto areas = random_areas(rng, 3);
    const Executor four(4);
    const Accelerator a = build_accelerator(scene, areas, two_binary_levels());
    const Accelerator b = build_accelerator(scene, areas, two_binary_levels(), four);
    const auto is_equal = [](const Bvh& x, const Bvh& y) {
        return x.prims == y.prims && x.nodes.size() == y.nodes.size() &&
               std::memcmp(x.nodes.data(), y.nodes.data(), x.nodes.size() * sizeof(Node)) == 0;
    };
    EXPECT_TRUE(is_equal(a.global_tree().binary()->tree, b.global_tree().binary()->tree));
    for (std::size_t i = 0; i < areas.size(); ++i) {
        EXPECT_TRUE(is_equal(
            a.local(to_area(i)).tree.binary()->tree, b.local(to_area(i)).tree.binary()->tree
        ));
    }
}

TEST(AreaHandle, TellsShadowFromLightTowardTheSunAndTheLamp) {
    // A roof of two triangles at y = 2 over x, z in [-1, 1].
    const Scene scene =
        soup_of({{{-1, 2, -1}, {1, 2, -1}, {1, 2, 1}}, {{-1, 2, -1}, {1, 2, 1}, {-1, 2, 1}}});
    const Aabb box{{-5, -1, -5}, {5, 6, 5}};
    const Accelerator accelerator = build_accelerator(
        scene,
        {InfluenceArea::parallel("sun", {.direction = {0, -1, 0}, .region = box}),
         InfluenceArea::radial("lamp", {.apex = {0, 4, 0}, .region = box})}
    );
    const std::vector<Vec3> points{{0, 0, 0}, {0.9F, 0, 0.9F}, {1.5F, 0, 0}, {0, 3, 0}, {4, 0, 0}};
    std::array<bool, 5> shadowed{};
    accelerator["sun"].occluded(points, shadowed);
    EXPECT_EQ(shadowed, (std::array{true, true, false, false, false}));
    accelerator["lamp"].occluded(points, shadowed);
    EXPECT_EQ(shadowed, (std::array{true, true, true, false, false}));

    // A point on the roof shades itself unless its ray starts off the surface.
    const std::vector<Vec3> on_roof{{0.5F, 2, 0.2F}};
    std::array<bool, 1> self{};
    accelerator["sun"].occluded(on_roof, self);
    EXPECT_TRUE(self[0]);
    accelerator["sun"].occluded(on_roof, self, 0.001F);
    EXPECT_FALSE(self[0]);
    accelerator["lamp"].occluded(on_roof, self, 0.001F);
    EXPECT_FALSE(self[0]);

    EXPECT_THROW(accelerator["sun"].occluded(points, self), Error);
    EXPECT_THROW(accelerator["sun"].occluded(points, shadowed, -1), Error);
}

TEST(Served, SaysWhoSearchedWhatAndCountsLikeCountedQuery) {
    Rng rng(39);
    const Scene scene = random_soup(rng, 100);
    const auto areas = random_areas(rng, 5);
    AcceleratorParams four_candidates = two_binary_levels();
    four_candidates.max_candidates = 4;
    const Accelerator accelerator = build_accelerator(scene, areas, four_candidates);
    for (int i = 0; i < 2000; ++i) {
        const Ray ray = random_ray(rng, scene, areas);
        Served served;
        CountedQuery counted;
        const auto hit = accelerator.closest_hit(ray, served);
        static_cast<void>(accelerator.closest_hit(ray, counted));
        ASSERT_EQ(served.total(), static_cast<const Counts&>(counted));
        const auto searches = served.searches();
        ASSERT_FALSE(searches.empty());
        ASSERT_EQ(searches.size(), counted.local_searches + counted.global_searches);
        ASSERT_EQ(searches.front().begin, ray.t_min);
        for (std::size_t k = 1; k < searches.size(); ++k) {
            ASSERT_GT(searches[k].begin, searches[k - 1].begin); // the proof moves on
            ASSERT_LE(searches[k].end, searches[k - 1].end);
        }
        ASSERT_EQ(served.answered() != nullptr, hit.has_value());
        if (hit) {
            ASSERT_LE(hit->t, served.answered()->end);
        }
    }
}

TEST(Accelerator, ForgoesAnAreaThatSavesNothing) {
    Rng rng(40);
    const Scene scene = random_soup(rng, 400);
    // A small box that every ray leaves at once: asking it comes on top of the global tree.
    const InfluenceArea small = InfluenceArea::parallel(
        "small", {.direction = {0, 0, 1}, .region = Aabb{{-0.1F, -0.1F, -0.1F}, {0.1F, 0.1F, 0.1F}}}
    );
    AcceleratorParams params = two_binary_levels();
    params.gain = GainParams{.rays = 256};
    const Accelerator accelerator = build_accelerator(scene, {small}, params);
    const LocalStructure& local = accelerator.local(AreaId{0});
    ASSERT_TRUE(local.gain);
    EXPECT_EQ(local.has_tree, *local.gain > 0);
    const PlainTree plain(scene);
    for (int i = 0; i < 200; ++i) {
        const Ray ray = random_ray(rng, scene, {small});
        Served served;
        ASSERT_TRUE(is_same(accelerator["small"].closest_hit(ray, served), plain.closest_hit(ray)));
        ASSERT_TRUE(local.has_tree || served.searches().size() == 1);
    }
    EXPECT_FALSE(build_accelerator(scene, {small}).local(AreaId{0}).gain);
}

TEST(Accelerator, MemoryIsThatOfTheContainers) {
    Rng rng(41);
    const Scene scene = random_soup(rng, 100);
    const Accelerator accelerator =
        build_accelerator(scene, random_areas(rng, 2), two_binary_levels());
    const AcceleratorMemory memory = accelerator.measure_memory();
    const Bvh& tree = accelerator.global_tree().binary()->tree;
    EXPECT_GE(
        memory.global_tree,
        tree.nodes.size() * 32 + scene.triangles.size() * 4 + tree.prims.size() * 36
    );
    EXPECT_GT(memory.local_trees, 0U);
    EXPECT_EQ(memory.grids, 0U);
    EXPECT_GE(memory.areas, 2 * sizeof(InfluenceArea));
    EXPECT_GT(memory.index, 0U);
    EXPECT_EQ(
        memory.total(),
        memory.global_tree + memory.local_trees + memory.grids + memory.areas + memory.index
    );
}

TEST(Accelerator, RefusesParametersThatMakeNoSense) {
    const Region region = Aabb{{0, 0, 0}, {1, 1, 1}};
    const auto refused = [&](const AcceleratorParams& params) {
        EXPECT_THROW(
            static_cast<void>(build_accelerator(Scene{}, {open_area("a", region)}, params)), Error
        );
    };
    refused({.max_candidates = 0});
    refused({.max_candidates = 9});
    refused({.membership = {.rule = Membership::vertices}});
    refused({.index = {.kind = RegionIndexKind::octree, .octree = {.mode = OctreeMode::over}}});
    refused({.gain = GainParams{.rays = 0}});
    const std::vector twins{open_area("a", region), open_area("a", region)};
    EXPECT_THROW(static_cast<void>(build_accelerator(Scene{}, twins)), Error);
    const Accelerator one = build_accelerator(Scene{}, {open_area("a", region)});
    EXPECT_THROW(static_cast<void>(one["b"]), Error);
    EXPECT_THROW(static_cast<void>(one[AreaId{1}]), Error);
    EXPECT_EQ(one["a"].id(), AreaId{0});
}

TEST(Accelerator, StopsWhenAskedTo) {
    std::stop_source source;
    source.request_stop();
    Progress progress;
    progress.stop = source.get_token();
    EXPECT_THROW(
        static_cast<void>(build_accelerator(Scene{}, {}, {}, serial_executor(), progress)),
        Cancelled
    );
}

} // namespace
} // namespace raywise
