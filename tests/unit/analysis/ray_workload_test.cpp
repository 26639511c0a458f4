#include <raywise/analysis/ray_workload.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/toplevel/pencil_of.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

namespace raywise {
namespace {

const Scene& courtyard() {
    static const Scene scene = generate_courtyard({.triangles = 18000});
    return scene;
}

const ExactOracle& oracle() {
    static const ExactOracle made(courtyard().view());
    return made;
}

Workload workload_of(const WorkloadParams& params, const Executor& executor = serial_executor()) {
    return make_workload(courtyard(), oracle(), all_ray_classes(), params, executor);
}

const InfluenceArea& area_named(const Workload& workload, const std::string& name) {
    return *std::find_if(workload.areas.begin(), workload.areas.end(), [&](const auto& area) {
        return area.name == name;
    });
}

TEST(MakeWorkload, GivesEveryClassRaysThatAreValidAndBelongToTheirAreas) {
    const Workload workload = workload_of({.paths = 4096, .emitters = 2});
    ASSERT_EQ(workload.classes.size(), all_ray_classes().size());
    std::set<std::string> names;
    for (const InfluenceArea& area : workload.areas)
        EXPECT_TRUE(names.insert(area.name).second) << area.name;
    for (const ClassRays& rays : workload.classes) {
        EXPECT_GT(rays.count(), 500U) << name_of(rays.rays);
        for (const EmitterRays& of_emitter : rays.emitters) {
            for (const Ray& ray : of_emitter.rays) {
                ASSERT_TRUE(is_valid(ray)) << name_of(rays.rays);
                if (of_emitter.area.empty()) continue;
                ASSERT_TRUE(is_affine(area_named(workload, of_emitter.area), ray))
                    << of_emitter.area;
            }
        }
    }
}

TEST(MakeWorkload, ExactClassesLieInThePencilBitForBit) {
    const Workload workload = workload_of({.paths = 2048});
    for (const ClassRays& rays : workload.classes) {
        if (kind_of(rays.rays) != RayKind::exact) continue;
        for (const EmitterRays& of_emitter : rays.emitters) {
            const Pencil pencil = pencil_of(area_named(workload, of_emitter.area)).value();
            for (const Ray& ray : of_emitter.rays)
                ASSERT_TRUE(pencil.holds(ray)) << of_emitter.area;
        }
    }
}

TEST(MakeWorkload, ShadowRaysBeginTheOffsetAwayFromTheirSurface) {
    const Workload workload = workload_of({.paths = 1024});
    EXPECT_GT(workload.offset, 0);
    for (const ClassRays& rays : workload.classes) {
        if (asks_closest(rays.rays) && rays.rays != RayClass::diffuse_bounce) continue;
        for (const EmitterRays& of_emitter : rays.emitters)
            for (const Ray& ray : of_emitter.rays)
                ASSERT_NEAR(
                    static_cast<double>(ray.t_min) * length(to_double(ray.direction)),
                    workload.offset,
                    1e-5 * workload.offset
                );
    }
}

TEST(MakeWorkload, IsTheSameForAnyExecutorAndAnotherForAnotherSeed) {
    const auto hash_of = [](const Workload& workload) {
        std::uint64_t hash = 0;
        for (const ClassRays& rays : workload.classes)
            for (const EmitterRays& of_emitter : rays.emitters)
                hash = hash_elements(std::span<const Ray>(of_emitter.rays), hash);
        return hash;
    };
    const std::uint64_t serial = hash_of(workload_of({.paths = 5000, .emitters = 3}));
    EXPECT_EQ(serial, hash_of(workload_of({.paths = 5000, .emitters = 3}, Executor(2))));
    EXPECT_NE(serial, hash_of(workload_of({.seed = 2, .paths = 5000, .emitters = 3})));
}

TEST(MakeWorkload, PutsEyesOutsideAndInsideInTurn) {
    const Workload workload = workload_of({.paths = 64, .emitters = 4});
    const Aabb box = bounds(courtyard());
    const ClassRays& primary = workload.classes.front();
    ASSERT_EQ(primary.emitters.size(), 4U);
    for (std::size_t e = 0; e < 4; ++e) {
        const Vec3d eye = to_double(primary.emitters[e].rays.front().origin);
        EXPECT_EQ(contains(box, eye), e % 2 == 1) << e;
    }
}

TEST(MakeWorkload, ASceneThatNothingHitsCastsNoShadowRays) {
    Scene point; // one triangle without area, but a scene with extent
    point.vertices = {{0, 0, 0}, {1, 1, 1}, {2, 2, 2}};
    point.triangles = {{0, 1, 2}};
    const ExactOracle nothing(point.view());
    const Workload workload = make_workload(point, nothing, all_ray_classes(), {.paths = 300});
    for (const ClassRays& rays : workload.classes) {
        const bool is_seen = rays.rays == RayClass::primary || rays.rays == RayClass::thin_lens;
        EXPECT_EQ(rays.count() > 0, is_seen) << name_of(rays.rays);
    }
}

TEST(MakeWorkload, WhatCannotBeMadeIsRefused) {
    const auto refused = [](const Scene& scene, const WorkloadParams& params) {
        EXPECT_THROW(
            static_cast<void>(make_workload(scene, oracle(), all_ray_classes(), params)), Error
        );
    };
    refused({}, {});
    Scene dot;
    dot.vertices = {{1, 1, 1}};
    dot.triangles = {{0, 0, 0}};
    refused(dot, {});
    refused(courtyard(), {.paths = 0});
    refused(courtyard(), {.emitters = 0});
    refused(courtyard(), {.emitters = 65});
    refused(courtyard(), {.up_axis = 3});
    refused(courtyard(), {.offset = -1});
}

} // namespace
} // namespace raywise
