// The accelerator with the structures that make it fast, against one plain tree over everything.
#include "support/random_areas.hpp"

#include <raywise/core/error.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/pencil_of.hpp>
#include <raywise/trace/all_hits.hpp>
#include <raywise/trace/closest_hit.hpp>
#include <raywise/trace/triangles.hpp>

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>

namespace raywise {
namespace {

using test_support::random_areas;
using test_support::random_ray;
using test_support::random_soup;

/// The oracle.
BinaryTree plain_tree(const Scene& scene) {
    Bvh tree = build_tree(build_input_of(scene.view()), surface_area_heuristic()).tree;
    PackedTriangles triangles(tree, scene.view());
    return {std::move(tree), std::move(triangles)};
}

bool is_same(const std::optional<Hit>& a, const std::optional<Hit>& b) {
    if (a.has_value() != b.has_value()) return false;
    return !a || (a->t == b->t && a->prim == b->prim && a->front == b->front);
}

AcceleratorParams forced(StructureKind kind) {
    AcceleratorParams params;
    params.use.structure = kind;
    return params;
}

/// A ray of the pencil: to the emitter, from it, cut short, on a surface.
Ray pencil_ray(Rng& rng, const Pencil& pencil, const Scene& scene) {
    const std::array<std::uint32_t, 3>& corner = scene.triangles[rng.below(scene.triangles.size())];
    Vec3 point = to_float(test_support::random_point(rng, -7, 7));
    if (rng.below(2) == 0) point = scene.vertices[corner[rng.below(3)]];
    Ray ray = pencil.shadow_ray(point);
    if (rng.below(3) == 0) ray.excluded = to_prim(rng.below(scene.triangles.size()));
    if (rng.below(3) == 0) ray.t_min = rng.uniform() / 2;
    if (rng.below(4) == 0) ray.t_max = 1 - rng.uniform() / 2;
    if (rng.below(2) == 0) return ray;
    if (pencil.kind() == Pencil::Kind::parallel) {
        ray.direction = pencil.direction();
    } else {
        ray = {.origin = pencil.apex(), .direction = point - pencil.apex()};
    }
    return ray;
}

TEST(Structures, EveryKindAnswersLikeOnePlainTree) {
    std::size_t by_grid = 0;
    std::size_t rays = 0;
    for (std::uint64_t seed = 0; seed < 80; ++seed) {
        Rng rng(51, seed);
        const Scene scene = random_soup(rng, 1 + rng.below(rng.below(2) == 0 ? 20 : 600));
        const auto areas = random_areas(rng, 1 + rng.below(5));
        AcceleratorParams params;
        for (const InfluenceArea& area : areas) {
            if (rng.below(2) == 0) params.uses[area.name].structure = StructureKind::wide_tree;
            if (rng.below(4) == 0) params.uses[area.name].expected_rays = 0;
            if (pencil_of(area) && rng.below(2) == 0)
                params.uses[area.name].structure = StructureKind::pencil_grid;
            const bool is_parallel =
                std::holds_alternative<ParallelDistribution>(area.distribution);
            if (is_parallel && rng.below(3) == 0)
                params.uses[area.name].structure = StructureKind::framed_tree;
        }
        const Accelerator accelerator = build_accelerator(scene, areas, params);
        const BinaryTree plain = plain_tree(scene);
        for (int i = 0; i < 400; ++i) {
            const AreaHandle handle = accelerator[to_area(rng.below(areas.size()))];
            const auto& pencil = accelerator.local(handle.id()).pencil;
            const Ray ray = pencil && rng.below(2) == 0 ? pencil_ray(rng, *pencil, scene)
                                                        : random_ray(rng, scene, areas);
            const auto expected = closest_hit(plain.tree, plain.triangles, ray);
            Served served;
            ASSERT_TRUE(is_same(accelerator.closest_hit(ray), expected)) << seed << " ray " << i;
            ASSERT_TRUE(is_same(accelerator.closest_hit(ray, served), expected));
            ASSERT_EQ(accelerator.any_hit(ray), expected.has_value()) << seed << " ray " << i;
            ASSERT_TRUE(is_same(handle.closest_hit(ray), expected)) << seed << " ray " << i;
            ASSERT_EQ(handle.any_hit(ray), expected.has_value()) << seed << " ray " << i;
            std::vector<Hit> all;
            accelerator.all_hits(ray, [&](const Hit& hit) { all.push_back(hit); });
            const auto sorted = sorted_hits(plain.tree, plain.triangles, ray);
            ASSERT_EQ(all.size(), sorted.size()) << seed << " ray " << i;
            for (std::size_t k = 0; k < all.size(); ++k)
                ASSERT_TRUE(is_same(all[k], sorted[k])) << seed << " ray " << i;
            ++rays;
            const Search* answer = served.answered();
            by_grid += answer && answer->area && accelerator.local(*answer->area).grid ? 1U : 0U;
        }
    }
    EXPECT_GT(by_grid, rays / 50);
}

TEST(Structures, BatchesOfExactRaysEqualSingleQueriesOnAnyNumberOfThreads) {
    const Scene scene = generate_courtyard({.triangles = 20'000});
    const Obb around = obb_around(bounds(scene));
    const std::vector areas{
        InfluenceArea::parallel("sun", {.direction = {0.3, -0.8, 0.5}, .region = around}),
        InfluenceArea::radial("lamp", {.apex = {0.5, 3, 0.25}, .region = around})
    };
    const Executor four(4);
    const Accelerator gridded =
        build_accelerator(scene, areas, forced(StructureKind::pencil_grid), four);
    const Accelerator drawn =
        build_accelerator(scene, areas, forced(StructureKind::inversion), four);
    const BinaryTree plain = plain_tree(scene);
    for (const AreaHandle handle : {gridded["sun"], gridded["lamp"], drawn["sun"], drawn["lamp"]}) {
        Rng rng(52);
        std::vector<Ray> rays;
        for (int i = 0; i < 40'000; ++i) {
            const Ray ray = pencil_ray(rng, handle.pencil(), scene);
            if (is_valid(ray)) rays.push_back(ray);
        }
        const auto any = std::make_unique<bool[]>(rays.size());
        std::vector<Hit> hits(rays.size());
        handle.any_hits(rays, {any.get(), rays.size()}, four);
        handle.closest_hits(rays, hits, four);
        for (std::size_t i = 0; i < rays.size(); ++i) {
            const auto expected = closest_hit(plain.tree, plain.triangles, rays[i]);
            ASSERT_EQ(any[i], expected.has_value()) << i;
            ASSERT_EQ(hits[i].prim, expected.value_or(Hit{}).prim) << i;
            ASSERT_EQ(hits[i].t, expected.value_or(Hit{}).t) << i;
        }
    }
}

TEST(Structures, InvalidRaysOfAGridMiss) {
    const Scene scene = generate_terrain({.triangles = 1'000});
    const Obb around = obb_around(bounds(scene));
    const std::vector areas{
        InfluenceArea::parallel("sun", {.direction = {0.3, -0.8, 0.5}, .region = around}),
        InfluenceArea::radial("lamp", {.apex = {500, 900, 500}, .region = around})
    };
    const Accelerator accelerator =
        build_accelerator(scene, areas, forced(StructureKind::pencil_grid));
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const AreaHandle handle : {accelerator["sun"], accelerator["lamp"]}) {
        std::vector<Ray> rays;
        for (const float bad : {nan, infinity, -infinity}) {
            for (int axis = 0; axis < 3; ++axis) {
                Vec3 point{500, 10, 500};
                point[axis] = bad;
                rays.push_back(handle.pencil().shadow_ray(point));
            }
            rays.push_back(handle.pencil().shadow_ray({500, 10, 500}, bad));
        }
        rays.push_back(handle.pencil().shadow_ray({500, 10, 500}, 2));
        rays.back().t_max = 1;
        rays.push_back({.origin = {500, 900, 500}, .direction = {0, 0, 0}});
        rays.push_back({.origin = {500, 900, 500}, .direction = {0, nan, 0}});
        for (const Ray& ray : rays) {
            EXPECT_FALSE(is_valid(ray) && ray.t_min < infinity);
            EXPECT_FALSE(handle.any_hit(ray));
            EXPECT_FALSE(handle.closest_hit(ray));
            EXPECT_FALSE(accelerator.any_hit(ray));
        }
    }
}

TEST(Structures, ASurfaceDoesNotShadeThePointsOnIt) {
    const Scene scene = generate_courtyard({.triangles = 20'000});
    const Obb everywhere = obb_around(bounds(scene));
    const InfluenceArea sun =
        InfluenceArea::parallel("sun", {.direction = {0.3, -0.8, 0.5}, .region = everywhere});
    std::vector<Vec3> points;
    std::vector<PrimId> surfaces;
    for (std::size_t i = 0; i < scene.triangles.size(); i += 7) {
        const Triangle triangle = scene.view()[to_prim(i)];
        points.push_back((triangle.v0 + triangle.v1 + triangle.v2) * (1.0F / 3));
        surfaces.push_back(to_prim(i));
    }
    const BinaryTree plain = plain_tree(scene);
    for (const StructureKind kind : {StructureKind::pencil_grid, StructureKind::none}) {
        AcceleratorParams params;
        params.use.structure = kind;
        const Accelerator accelerator = build_accelerator(scene, {sun}, params);
        const AreaHandle handle = accelerator["sun"];
        const auto shadowed = std::make_unique<bool[]>(points.size());
        handle.occluded(points, surfaces, {shadowed.get(), points.size()});
        for (std::size_t i = 0; i < points.size(); ++i) {
            const Ray ray = handle.pencil().shadow_ray(points[i], 0, surfaces[i]);
            const bool wanted = closest_hit(plain.tree, plain.triangles, ray).has_value();
            ASSERT_EQ(shadowed[i], wanted) << i;
            ASSERT_EQ(handle.occluded(points[i], 0, surfaces[i]), wanted) << i;
        }
    }
}

TEST(Structures, ChoiceFollowsTheExpectedRays) {
    const Scene scene = generate_terrain({.triangles = 20'000});
    const InfluenceArea sun = InfluenceArea::parallel(
        "sun", {.direction = {0.3, -0.8, 0.5}, .region = obb_around(bounds(scene))}
    );
    const auto choice_for = [&](double rays) {
        AcceleratorParams params;
        params.uses["sun"].expected_rays = rays;
        return build_accelerator(scene, {sun}, params)["sun"].choice();
    };
    EXPECT_EQ(choice_for(0).kind, StructureKind::none);
    for (const double rays : {1e4, 1e5, 1e6}) {
        const StructureChoice choice = choice_for(rays);
        EXPECT_EQ(choice.kind, cheapest(choice.predictions, rays).kind);
        EXPECT_EQ(choice.predictions.size(), 3U);
    }
    EXPECT_EQ(choice_for(1e9).kind, StructureKind::pencil_grid);
    EXPECT_EQ(choice_for(1e9).predictions.front().kind, StructureKind::none);
    const AcceleratorParams many{.use = {.expected_rays = 1e9}};
    const std::string text = build_accelerator(scene, {sun}, many)["sun"].explain();
    EXPECT_NE(text.find("pencil_grid, cheapest for 1e+09 rays"), std::string::npos) << text;
    EXPECT_NE(text.find("pays from"), std::string::npos) << text;
}

TEST(Structures, BlurredSunGetsAFrameOnlyWhereCountingSaysSo) {
    const Scene forest = generate_forest({.triangles = 20'000});
    const InfluenceArea sun = InfluenceArea::parallel(
        "sun",
        {.direction = {0.5, -0.7, 0.5},
         .region = obb_around(bounds(forest)),
         .cone_half_angle_deg = 0.27}
    );
    const Accelerator few = build_accelerator(forest, {sun}, {.use = {.expected_rays = 1e3}});
    EXPECT_EQ(few["sun"].choice().kind, StructureKind::none);
    EXPECT_EQ(few["sun"].choice().predictions.size(), 1U); // not even tried
    const Accelerator many = build_accelerator(forest, {sun}, {.use = {.expected_rays = 1e10}});
    const StructureChoice& choice = many["sun"].choice();
    ASSERT_EQ(choice.predictions.size(), 2U);
    EXPECT_EQ(choice.kind, cheapest(choice.predictions, 1e10).kind);
    EXPECT_EQ(
        many.local(AreaId{0}).has_tree, choice.predictions[1].ray_ns < choice.predictions[0].ray_ns
    );
}

TEST(Structures, UnknownRaysOfAPencilFindItsGrid) {
    const Scene scene = generate_terrain({.triangles = 5'000});
    const InfluenceArea sun = InfluenceArea::parallel(
        "sun", {.direction = {0.3, -0.8, 0.5}, .region = obb_around(bounds(scene))}
    );
    const Accelerator accelerator =
        build_accelerator(scene, {sun}, forced(StructureKind::pencil_grid));
    Served served;
    static_cast<void>(
        accelerator.any_hit(accelerator["sun"].pencil().shadow_ray({1, 500, 1}), served)
    );
    ASSERT_EQ(served.searches().size(), 1U);
    EXPECT_EQ(served.searches()[0].area, AreaId{0});
    Served other;
    static_cast<void>(accelerator.any_hit({.origin = {1, 500, 1}, .direction = {1, 1, 1}}, other));
    ASSERT_EQ(other.searches().size(), 1U);
    EXPECT_FALSE(other.searches()[0].area);
}

TEST(Structures, RefusesWhatCannotBe) {
    const Scene scene = generate_terrain({.triangles = 1'000});
    const Obb around = obb_around(bounds(scene));
    const std::vector blurred{InfluenceArea::parallel(
        "sun", {.direction = {0.3, -0.8, 0.5}, .region = around, .cone_half_angle_deg = 1}
    )};
    const auto refused = [&](const AcceleratorParams& params) {
        EXPECT_THROW(static_cast<void>(build_accelerator(scene, blurred, params)), Error);
    };
    refused(forced(StructureKind::pencil_grid));
    refused(forced(StructureKind::inversion));
    AcceleratorParams params;
    params.global_structure = StructureKind::pencil_grid;
    refused(params);
    params = {};
    params.uses["moon"].expected_rays = 1;
    refused(params);
    params = {};
    params.use.expected_rays = -1;
    refused(params);
    EXPECT_THROW(static_cast<void>(build_accelerator(scene, blurred)["sun"].pencil()), Error);
}

} // namespace
} // namespace raywise
