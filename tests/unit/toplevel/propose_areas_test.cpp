#include <raywise/toplevel/propose_areas.hpp>

#include "support/random_areas.hpp"

#include <raywise/core/error.hpp>
#include <raywise/scene/generate.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

namespace raywise {
namespace {

constexpr double degree = std::numbers::pi / 180;

/// A box room of 4 x 3 x 6 with its floor at y = 0.
Scene room() {
    Scene scene;
    const Aabb box{{-2, 0, -3}, {2, 3, 3}};
    for (int i = 0; i < 8; ++i)
        scene.vertices.push_back(box.vertex(i));
    scene.triangles = {
        {0, 1, 4},
        {1, 5, 4},
        {2, 6, 3},
        {3, 6, 7},
        {0, 2, 1},
        {1, 2, 3},
        {4, 5, 6},
        {5, 7, 6},
        {0, 4, 2},
        {2, 4, 6},
        {1, 3, 5},
        {3, 7, 5}
    };
    return scene;
}

bool holds_scene(const Region& region, const Scene& scene) {
    for (const Vec3 vertex : scene.vertices) {
        if (!contains(region, to_double(vertex))) return false;
    }
    return true;
}

TEST(ProposeAreas, ADirectionalLightHasParallelRaysAroundTheWholeScene) {
    Scene scene = room();
    Light sun;
    sun.name = "noon";
    sun.kind = LightKind::directional;
    sun.direction = {0, -2, 0};
    scene.lights = {sun};
    const auto areas = propose_areas(scene);
    ASSERT_EQ(areas.size(), 1U);
    EXPECT_EQ(areas[0].name, "noon");
    EXPECT_TRUE(holds_scene(areas[0].region, scene));
    const auto& distribution = std::get<ParallelDistribution>(areas[0].distribution);
    EXPECT_NEAR(distribution.params().frame.forward.y, -1, 1e-12);
    // A shadow ray from the floor is affine.
    EXPECT_TRUE(is_affine(areas[0], {.origin = {1, 0, 1}, .direction = {0, 1, 0}}));
}

TEST(ProposeAreas, APointLightShinesInItsRangeAndASpotInItsCone) {
    Scene scene = room();
    Light lamp;
    lamp.position = {0, 2, 0};
    lamp.range = 1;
    Light spot;
    spot.kind = LightKind::spot;
    spot.position = {0.1, 2.9, 0.1};
    spot.direction = {0, -1, 0};
    spot.cone_rad = 30 * degree;
    Light wide = spot;
    wide.cone_rad = 85 * degree;
    scene.lights = {lamp, spot, wide};
    const auto areas = propose_areas(scene);
    ASSERT_EQ(areas.size(), 3U);
    EXPECT_EQ(areas[0].name, "light");
    EXPECT_EQ(areas[1].name, "light 2");
    EXPECT_EQ(areas[2].name, "light 3");
    EXPECT_TRUE(contains(areas[0].region, Vec3d{0.9, 2, 0}));
    EXPECT_FALSE(contains(areas[0].region, Vec3d{1.1, 2, 0}));
    EXPECT_TRUE(std::holds_alternative<Frustum>(areas[1].region));
    EXPECT_TRUE(contains(areas[1].region, Vec3d{0.1, 0, 0.1}));
    EXPECT_TRUE(contains(areas[1].region, Vec3d{0.1 + 2.9 * 0.57, 0, 0.1}));
    EXPECT_FALSE(contains(areas[1].region, Vec3d{1.9, 2.5, 0.1}));
    EXPECT_TRUE(holds_scene(areas[2].region, scene)); // too wide for a frustum
    for (const InfluenceArea& area : areas) {
        const auto& params = std::get<RadialDistribution>(area.distribution).params();
        EXPECT_EQ(params.emission, Emission::isotropic);
        for (int axis = 0; axis < 3; ++axis) {
            const volatile float rounded = static_cast<float>(params.eye[axis]);
            EXPECT_EQ(static_cast<double>(rounded), params.eye[axis]);
        }
    }
}

TEST(ProposeAreas, CameraRaysStartInTheirArea) {
    Scene scene = room();
    Camera view;
    view.name = "view";
    view.eye = {0.1, 1.7, 9.3};
    view.frame = frame_along({0.1, -0.1, -1});
    view.fov_x_rad = 60 * degree;
    view.fov_y_rad = 40 * degree;
    view.near = 0.1;
    Camera plan;
    plan.projection = Projection::orthographic;
    plan.eye = {0, 10, 0};
    plan.frame = frame_along({0, -1, 0});
    plan.half_width = 3;
    plan.half_height = 4;
    scene.cameras = {view, plan};
    const auto areas = propose_areas(scene);
    ASSERT_EQ(areas.size(), 2U);
    EXPECT_EQ(areas[0].name, "view");
    EXPECT_EQ(areas[1].name, "camera");
    for (const InfluenceArea& area : areas) {
        for (std::uint64_t i = 0; i < 200; ++i) {
            Rng rng(61, i);
            ASSERT_TRUE(is_affine(area, sample(area.distribution, rng))) << area.name;
        }
    }
    EXPECT_EQ(
        std::get<RadialDistribution>(areas[0].distribution).params().emission, Emission::pinhole
    );
    const auto& window = std::get<ParallelDistribution>(areas[1].distribution).params();
    EXPECT_NEAR(window.half_width * window.half_height, 12, 1e-9);
}

TEST(ProposeAreas, MostRaysDrawnFromADefaultAreaAreAnsweredByIt) {
    const Scene scene = generate_random_triangles(500);
    for (const InfluenceArea& area : propose_areas(scene)) {
        int affine = 0;
        for (std::uint64_t i = 0; i < 1000; ++i) {
            Rng rng(63, i);
            affine += is_affine(area, sample(area.distribution, rng)) ? 1 : 0;
        }
        EXPECT_GE(
            affine, 995
        ) << area.name; // sides of the region are as sharp as those of the window
    }
}

TEST(ProposeAreas, WhatCannotReachTheSceneIsLeftOut) {
    Scene scene = room();
    Light far_lamp;
    far_lamp.position = {100, 0, 0};
    far_lamp.range = 5;
    Camera away;
    away.eye = {0, 1, 10};
    away.frame = frame_along({0, 0, 1});
    scene.lights = {far_lamp};
    scene.cameras = {away};
    EXPECT_TRUE(propose_areas(scene).empty());
}

TEST(ProposeAreas, ASceneWithoutLightsHasADefaultSetForAnyUp) {
    Rng rng(62);
    for (const Scene& scene :
         {room(), test_support::random_soup(rng, 300), generate_random_triangles(100)}) {
        for (const Vec3d up : {Vec3d{0, 1, 0}, Vec3d{0, 0, 5}, Vec3d{-1, 0, 0}}) {
            const auto areas = propose_areas(scene, {.up = up});
            ASSERT_EQ(areas.size(), 3U);
            EXPECT_EQ(areas[0].name, "sun");
            EXPECT_EQ(areas[1].name, "lamp");
            EXPECT_EQ(areas[2].name, "camera");
            for (const InfluenceArea& area : areas) {
                EXPECT_TRUE(holds_scene(area.region, scene)) << area.name;
            }
            const Vec3d sun =
                std::get<ParallelDistribution>(areas[0].distribution).params().frame.forward;
            EXPECT_LT(dot(sun, normalized(up)), -0.7);
            const auto& lamp = std::get<RadialDistribution>(areas[1].distribution).params();
            EXPECT_TRUE(contains(Region{bounds(scene)}, lamp.eye));
            const auto& camera = std::get<RadialDistribution>(areas[2].distribution).params();
            EXPECT_FALSE(contains(Region{bounds(scene)}, camera.eye));
            EXPECT_GT(dot(camera.eye - to_double(bounds(scene).center()), up), 0);
        }
    }
}

TEST(ProposeAreas, TheDefaultLampHangsInOpenSpace) {
    // A room whose one half is filled with plates: the other half has the room.
    Scene scene = room();
    for (int i = 0; i < 60; ++i) {
        const auto first = static_cast<std::uint32_t>(scene.vertices.size());
        const float x = -2 + 0.04F * static_cast<float>(i) * 0.5F;
        scene.vertices.insert(scene.vertices.end(), {{x, 0, -3}, {x, 3, -3}, {x, 0, 9}});
        scene.triangles.push_back({first, first + 1, first + 2});
    }
    const auto areas = propose_areas(scene, {.seed = 3});
    EXPECT_GT(std::get<RadialDistribution>(areas.at(1).distribution).params().eye.x, -0.5);
}

TEST(ProposeAreas, IsDeterministicAndTheSeedMovesTheLamp) {
    const Scene scene = generate_random_triangles(200);
    const auto eye_of = [&](std::uint64_t seed) {
        const auto areas = propose_areas(scene, {.seed = seed});
        return std::get<RadialDistribution>(areas.at(1).distribution).params().eye;
    };
    EXPECT_EQ(eye_of(1), eye_of(1));
    EXPECT_NE(eye_of(1), eye_of(2));
}

TEST(ProposeAreas, FlatScenesAndPointsHaveAreasToo) {
    Scene flat = test_support::soup_of({{{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}}});
    Scene point = test_support::soup_of({{{5, 5, 5}, {5, 5, 5}, {5, 5, 5}}});
    Scene far_away = test_support::soup_of({{{1e9F, 0, 0}, {1e9F, 1, 0}, {1e9F, 0, 1}}});
    for (const Scene& scene : {flat, point, far_away}) {
        const auto areas = propose_areas(scene, {.margin = 0});
        ASSERT_EQ(areas.size(), 3U);
        EXPECT_TRUE(holds_scene(areas[0].region, scene));
        EXPECT_TRUE(holds_scene(areas[1].region, scene));
    }
    EXPECT_TRUE(propose_areas(Scene{}).empty());
}

TEST(ProposeAreas, GeneratedScenesGetTheirLightsAndCameras) {
    const Scene scene = generate_courtyard({.triangles = 2000});
    const auto areas = propose_areas(scene);
    EXPECT_EQ(areas.size(), scene.lights.size() + scene.cameras.size());
    std::set<std::string> names;
    for (const InfluenceArea& area : areas)
        names.insert(area.name);
    EXPECT_EQ(names.size(), areas.size());
}

TEST(ProposeAreas, RefusesParametersOutOfRange) {
    EXPECT_THROW(static_cast<void>(propose_areas(room(), {.up = {0, 0, 0}})), Error);
    EXPECT_THROW(static_cast<void>(propose_areas(room(), {.margin = -1})), Error);
}

} // namespace
} // namespace raywise
