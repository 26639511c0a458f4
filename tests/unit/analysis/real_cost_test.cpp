#include <raywise/analysis/real_cost.hpp>

#include <raywise/analysis/estimated_cost.hpp>
#include <raywise/build/binned.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/trace/brute_force.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace raywise {
namespace {

struct Soup {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;

    [[nodiscard]] TriangleView view() const { return {vertices, triangles}; }
};

/// Small triangles in the unit cube about the origin.
Soup soup_of(std::size_t count) {
    Soup soup;
    Rng rng(11);
    const auto between = [&](float lo, float hi) { return lo + (hi - lo) * rng.uniform(); };
    for (std::uint32_t i = 0; i < count; ++i) {
        const Vec3 at{between(-0.4F, 0.4F), between(-0.4F, 0.4F), between(-0.4F, 0.4F)};
        for (int k = 0; k < 3; ++k) {
            soup.vertices.push_back(
                at + Vec3{between(-0.1F, 0.1F), between(-0.1F, 0.1F), between(-0.1F, 0.1F)}
            );
        }
        soup.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    return soup;
}

Bvh tree_over(const Soup& soup) {
    std::vector<Aabb> boxes;
    for (std::size_t i = 0; i < soup.triangles.size(); ++i) {
        boxes.push_back(bounds(soup.view()[to_prim(i)]));
    }
    return build_binned(boxes, SurfaceMeasure{});
}

std::vector<Ray> draw(const Distribution& distribution, std::size_t count) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < count; ++i) {
        Rng rng(5, i);
        rays.push_back(sample(distribution, rng));
    }
    return rays;
}

TEST(RealCost, OfNothingIsZero) {
    EXPECT_EQ(measure_real_cost(Bvh{}, {}).cost, 0);
    EXPECT_EQ(summarize(std::vector<TracedRay>{}).cost.count, 0U);
    const std::vector<Ray> rays{{.origin = {}, .direction = {0, 0, 1}}};
    const MeanCounts none = measure_real_cost(Bvh{}, rays);
    EXPECT_EQ(none.rays, 1U);
    EXPECT_EQ(none.meeting, 0U);
    EXPECT_EQ(none.cost, 0);
}

TEST(RealCost, CountsARayThatMissesTheRootAsFree) {
    const Soup soup = soup_of(20);
    const std::vector<Ray> rays{
        {.origin = {0, 0, -5}, .direction = {0, 0, 1}},
        {.origin = {9, 9, -5}, .direction = {0, 0, 1}}
    };
    const Bvh tree = tree_over(soup);
    const MeanCounts both = measure_real_cost(tree, rays);
    const MeanCounts hitting = measure_real_cost(tree, std::span(rays).first(1));
    EXPECT_EQ(both.meeting, 1U);
    EXPECT_GT(hitting.cost, 0);
    EXPECT_DOUBLE_EQ(both.cost, hitting.cost / 2);
    EXPECT_DOUBLE_EQ(both.hits_per_ray(), hitting.hits_per_ray() / 2);
}

TEST(RealCost, WeighsOpenedNodesAndTriangleTests) {
    const std::vector<Counts> counts{
        {.boxes = 5, .inners = 2, .leaves = 1, .prims = 4}, {.boxes = 1}
    };
    const MeanCounts mean = mean_counts(counts);
    EXPECT_DOUBLE_EQ(mean.cost, (2 * 2 + 1.2 * 4) / 2);
    EXPECT_DOUBLE_EQ(mean.box_hits, 1.5);
    EXPECT_DOUBLE_EQ(mean.box_tests, 3);
    EXPECT_DOUBLE_EQ(mean.hits_per_ray(), 3.5);
    EXPECT_EQ(mean.meeting, 1U);
}

TEST(OrderedCost, NeverExceedsTheUnorderedOneAndFindsWhatBruteForceFinds) {
    const Soup soup = soup_of(200);
    const Bvh tree = tree_over(soup);
    const std::vector<Ray> rays = draw(UniformDistribution(tree.root().box()), 500);
    const PackedTriangles triangles(tree, soup.view());
    const std::vector<TracedRay> closest = trace_closest_counted(tree, triangles, rays);
    const std::vector<TracedRay> any = trace_any_counted(tree, triangles, rays);
    const std::vector<Counts> unpruned = count_unpruned(tree, rays);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < rays.size(); ++i) {
        const std::optional<Hit> truth = brute_force_closest_hit(soup.view(), rays[i]);
        ASSERT_EQ(closest[i].hit.has_value(), truth.has_value());
        ASSERT_EQ(any[i].hit.has_value(), truth.has_value());
        if (truth) {
            ASSERT_EQ(closest[i].hit->prim, truth->prim);
            ++hits;
        }
        // The conservative box test of a traversal may open a box that the exact one refuses.
        EXPECT_LE(cost_of(closest[i].counts), cost_of(unpruned[i]) + 2);
    }
    const OrderedCost ordered = summarize(closest);
    EXPECT_DOUBLE_EQ(ordered.hit_fraction, static_cast<double>(hits) / 500);
    EXPECT_LE(summarize(any).cost.mean, ordered.cost.mean);
}

TEST(OrderedCost, IsTheSameForAnyNumberOfThreads) {
    const Soup soup = soup_of(200);
    const Bvh tree = tree_over(soup);
    const std::vector<Ray> rays = draw(UniformDistribution(tree.root().box()), 3000);
    const IndexedTriangles triangles(soup.view());
    const Executor two(2);
    const OrderedCost serial = summarize(trace_closest_counted(tree, triangles, rays));
    const OrderedCost parallel = summarize(trace_closest_counted(tree, triangles, rays, two));
    EXPECT_EQ(serial.cost.mean, parallel.cost.mean);
    EXPECT_EQ(measure_real_cost(tree, rays).cost, measure_real_cost(tree, rays, {}, two).cost);
}

struct Family {
    std::string name;
    std::function<Distribution(const Aabb& scene)> make;
};

RadialParams eye_in_front(Emission emission) {
    return {
        .eye = {0.3, 0.2, -2},
        .frame = frame_along({-0.1, -0.1, 1}),
        .window = window_of_fov(40, 30),
        .emission = emission
    };
}

Distribution recorded(const Aabb& scene) {
    MeasuredParams params;
    params.bounds = scene;
    params.shrinkage = 5;
    for (std::size_t i = 0; i < 300; ++i) {
        Rng rng(77, i);
        const Ray ray = UniformDistribution(scene).sample(rng);
        params.rays.push_back({.ray = ray, .weight = i % 3 == 0 ? 2.0 : 0.5});
    }
    return MeasuredDistribution(params);
}

class Identity : public testing::TestWithParam<Family> {};

TEST_P(Identity, MeanCountedCostOfItsOwnRaysIsTheEstimate) {
    const Bvh tree = tree_over(soup_of(300));
    const Distribution distribution = GetParam().make(tree.root().box());
    const double estimate = std::visit(
        [&](const auto& chosen) {
            return estimate_cost(tree, chosen.measure(), Normalization::absolute).total();
        },
        distribution
    );
    const std::vector<Counts> counts = count_unpruned(tree, draw(distribution, 40'000));
    std::vector<double> costs;
    for (const Counts& of_ray : counts)
        costs.push_back(cost_of(of_ray));
    const ConfidenceInterval real = confidence_95(costs);
    EXPECT_GT(estimate, 1);
    // Twice the 95 % interval: four standard errors of the mean.
    EXPECT_NEAR(real.mean, estimate, 2 * real.half_width) << GetParam().name;
    EXPECT_LT(real.half_width, 0.02 * estimate);
}

INSTANTIATE_TEST_SUITE_P(
    OfEveryFamily,
    Identity,
    testing::Values(
        Family{
            "uniform",
            [](const Aabb& scene) -> Distribution { return UniformDistribution(scene); }
        },
        Family{
            "parallel_along_axis",
            [](const Aabb&) -> Distribution {
                return ParallelDistribution(
                    {.point = {0, 0, -2},
                     .frame = frame_along({0, 0, 1}),
                     .half_width = 0.6,
                     .half_height = 0.3}
                );
            }
        },
        Family{
            "parallel_oblique",
            [](const Aabb&) -> Distribution {
                return ParallelDistribution(
                    {.point = {-1, -1, -1},
                     .frame = frame_along({1, 1.2, 0.9}),
                     .half_width = 0.5,
                     .half_height = 0.4}
                );
            }
        },
        Family{
            "parallel_inside",
            [](const Aabb&) -> Distribution {
                return ParallelDistribution(
                    {.point = {0, 0, 0},
                     .frame = frame_along({0.2, -1, 0.1}),
                     .half_width = 0.5,
                     .half_height = 0.4}
                );
            }
        },
        Family{
            "pinhole",
            [](const Aabb&) -> Distribution {
                return RadialDistribution(eye_in_front(Emission::pinhole));
            }
        },
        Family{
            "isotropic",
            [](const Aabb&) -> Distribution {
                return RadialDistribution(eye_in_front(Emission::isotropic));
            }
        },
        Family{
            "yaw_pitch",
            [](const Aabb&) -> Distribution {
                return RadialDistribution(eye_in_front(Emission::yaw_pitch));
            }
        },
        Family{
            "pinhole_inside",
            [](const Aabb&) -> Distribution {
                RadialParams params = eye_in_front(Emission::pinhole);
                params.eye = {0.05, 0.1, 0.02};
                return RadialDistribution(params);
            }
        },
        Family{
            "lamp_inside",
            [](const Aabb&) -> Distribution {
                return RadialDistribution(
                    {.eye = {0.1, 0, 0.05},
                     .frame = {},
                     .window = {},
                     .emission = Emission::isotropic}
                );
            }
        },
        Family{"recorded", recorded}
    ),
    [](const auto& family) { return family.param.name; }
);

} // namespace
} // namespace raywise
