// Trees for recorded rays, judged by other rays of the same kind.
#include <raywise/build/spatial.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/local_segment_measure.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/geometry/segment_measure.hpp>
#include <raywise/optimize/reinsertion.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/trace/closest_hit.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/terminate.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace raywise {
namespace {

constexpr std::size_t ray_count = 4096; // to learn from, and as many to judge by

struct RayKind {
    std::string name;
    std::vector<Ray> rays; ///< twice ray_count, independent of each other
};

/// From a few eyes in the scene, in all directions.
std::vector<Ray> eye_rays(const Aabb& box) {
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < 2 * ray_count; ++i) {
        Rng place(1, i % 6);
        Rng rng(2, i);
        const Vec3 margin = box.size() * 0.2F;
        rays.push_back(
            {sample_box({box.lo + margin, box.hi - margin}, place), to_float(sample_sphere(rng))}
        );
    }
    return rays;
}

/// From above the scene along one direction, as a sun's.
std::vector<Ray> sun_rays(const Aabb& box) {
    const Vec3 direction{0.3F, -0.8F, 0.5F};
    std::vector<Ray> rays;
    for (std::size_t i = 0; i < 2 * ray_count; ++i) {
        Rng rng(3, i);
        const Vec3 point = sample_box(box, rng);
        const float back = 2 * length(box.size());
        rays.push_back({point - direction * back, direction});
    }
    return rays;
}

/// From where the rays before hit, in all directions.
std::vector<Ray> bounces(const Scene& scene, const Bvh& tree, const std::vector<Ray>& rays) {
    std::vector<Ray> result;
    for (std::size_t i = 0; result.size() < 2 * ray_count; ++i) {
        const Ray& ray = rays[i % rays.size()];
        const auto hit = closest_hit(tree, IndexedTriangles(scene.view()), ray);
        Rng rng(4, i);
        const Vec3 direction = to_float(sample_sphere(rng));
        if (!hit) {
            result.push_back({sample_box(bounds(scene), rng), direction});
            continue;
        }
        Ray bounce{point_at(ray, hit->t), direction};
        bounce.excluded = hit->prim;
        result.push_back(bounce);
    }
    return result;
}

double mean_cost(const Bvh& tree, const Scene& scene, std::span<const Ray> rays) {
    Counts counts;
    for (const Ray& ray : rays)
        static_cast<void>(closest_hit(tree, IndexedTriangles(scene.view()), ray, counts));
    return cost_of(counts) / static_cast<double>(rays.size());
}

TEST(MeasuredTrees, AreNeverMuchDearerOnOtherRaysAndCheaperInTheMean) {
    const Executor executor;
    const GenerateParams small{.triangles = 20'000};
    const std::vector<Scene> scenes{
        generate_courtyard(small),
        generate_city(small),
        generate_forest(small),
        generate_terrain(small),
        generate_spheres(small),
    };
    double log_sum = 0;
    int cases = 0;
    for (const Scene& scene : scenes) {
        const Aabb box = bounds(scene);
        const auto build = [&](const auto& measure) {
            const Bvh tree = build_spatial(scene.view(), measure, {}, executor);
            return reinsert(tree, SurfaceMeasure{}, {}, executor);
        };
        const Bvh surface = build(SurfaceMeasure{});
        const std::vector<Ray> eyes = eye_rays(box);
        const std::vector<RayKind> kinds{
            {"eyes", eyes}, {"sun", sun_rays(box)}, {"bounces", bounces(scene, surface, eyes)}
        };
        for (const RayKind& kind : kinds) {
            SCOPED_TRACE(scene.name + ", " + kind.name);
            const std::span<const Ray> all = kind.rays;
            const std::vector<Ray> segments =
                terminated(surface, IndexedTriangles(scene.view()), all.first(ray_count), executor);
            const SegmentMeasure counted(segments, box);
            const Bvh measured = reinsert(
                build(LocalSegmentMeasure(counted, box)),
                counted,
                {.batch = 0.02, .max_rounds = 3},
                executor
            );
            const double ratio = mean_cost(measured, scene, all.last(ray_count)) /
                                 mean_cost(surface, scene, all.last(ray_count));
            EXPECT_LT(ratio, 1.02);
            log_sum += std::log(ratio);
            ++cases;
        }
    }
    EXPECT_LT(std::exp(log_sum / cases), 0.96);
}

} // namespace
} // namespace raywise
