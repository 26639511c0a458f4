// Generated scenes: reproducible, of the size asked for, and what their names promise.
#include <raywise/scene/generate.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/hash.hpp>
#include <raywise/scene/scene.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <ostream>
#include <random>
#include <string>

namespace raywise {
namespace {

TEST(GenerateRandomTriangles, NoneAreAnEmptyScene) {
    EXPECT_TRUE(generate_random_triangles(0).triangles.empty());
}

TEST(GenerateRandomTriangles, FollowsTheStandardLibrarysDrawOnOneStream) {
    // libstdc++ draws a double in [a, b) from two 32-bit words: the oracle where it is in use.
    std::mt19937 words(1);
    std::uniform_real_distribution<double> in_cube(0, 10);
    std::uniform_real_distribution<double> near(-1, 1);
    const Scene first = generate_random_triangles(100, 1);
    const Scene second = generate_random_triangles(1000, 1, 100);
    for (const Scene* scene : {&first, &second})
        for (std::size_t i = 0; i < scene->vertices.size(); i += 3) {
            Vec3 v;
            for (std::size_t k = 0; k < 3; ++k) {
                Vec3 step;
                for (int axis = 0; axis < 3; ++axis)
                    step[axis] = static_cast<float>((k == 0 ? in_cube : near)(words));
                v = v + step;
                ASSERT_EQ(scene->vertices[i + k], v) << i;
            }
        }
}

struct Named {
    std::string name;
    Scene (*generate)(const GenerateParams&);
    std::uint64_t hash; ///< of 20,000 triangles, seed 1: the same on every platform
};

void PrintTo(const Named& named, std::ostream* out) {
    *out << named.name;
}

class Generated : public testing::TestWithParam<Named> {};

TEST_P(Generated, HasAboutTheTrianglesAskedFor) {
    for (const std::size_t triangles : {20'000U, 60'000U, 200'000U}) {
        const Scene scene = GetParam().generate({.triangles = triangles, .seed = 1});
        EXPECT_GE(
            static_cast<double>(scene.triangles.size()), 0.75 * static_cast<double>(triangles)
        );
        EXPECT_LE(
            static_cast<double>(scene.triangles.size()), 1.25 * static_cast<double>(triangles)
        );
    }
}

TEST_P(Generated, IsValidWithNoDegenerateTriangleAndAViewOfItself) {
    const Scene scene = GetParam().generate({.triangles = 20'000, .seed = 1});
    EXPECT_NO_THROW(validate(scene));
    EXPECT_EQ(count_degenerate(scene), 0U);
    ASSERT_EQ(scene.cameras.size(), 1U);
    EXPECT_FALSE(scene.lights.empty());
    EXPECT_EQ(scene.name, GetParam().name);
    // Some of the scene is in front of the camera, within its field of view.
    const Camera& camera = scene.cameras[0];
    const auto is_seen = [&](Vec3 vertex) {
        const Vec3d p = to_frame(camera.frame, to_double(vertex) - camera.eye);
        return p.z > camera.near && p.z < camera.far &&
               std::abs(p.x) < p.z * std::tan(camera.fov_x_rad / 2) &&
               std::abs(p.y) < p.z * std::tan(camera.fov_y_rad / 2);
    };
    const auto seen = std::count_if(scene.vertices.begin(), scene.vertices.end(), is_seen);
    EXPECT_GT(static_cast<double>(seen), 0.2 * static_cast<double>(scene.vertices.size()));
}

TEST_P(Generated, IsReproducibleAndFollowsItsSeed) {
    const auto hash = [](const GenerateParams& params) {
        return content_hash(GetParam().generate(params));
    };
    EXPECT_EQ(hex(hash({.triangles = 20'000, .seed = 1})), hex(GetParam().hash));
    EXPECT_NE(hash({.triangles = 20'000, .seed = 2}), GetParam().hash);
}

TEST_P(Generated, RefusesSizesOutOfRange) {
    EXPECT_THROW((void)GetParam().generate({.triangles = 99}), Error);
    EXPECT_THROW((void)GetParam().generate({.triangles = 100'000'001}), Error);
    EXPECT_NO_THROW((void)GetParam().generate({.triangles = 100}));
}

INSTANTIATE_TEST_SUITE_P(
    All,
    Generated,
    testing::Values(
        Named{"courtyard", generate_courtyard, 0x0FDE0C1F73842596ULL},
        Named{"city", generate_city, 0xEDA3538107090BF1ULL},
        Named{"forest", generate_forest, 0xE5F453C53655B215ULL},
        Named{"terrain", generate_terrain, 0x2E34C03FAEA1F231ULL},
        Named{"spheres", generate_spheres, 0xFB18BB79C2117CB0ULL}
    ),
    [](const auto& instance) { return instance.param.name; }
);

TEST(GenerateCourtyard, HasASunALampUnderTheArcadeAndNamedParts) {
    const Scene scene = generate_courtyard();
    ASSERT_EQ(scene.lights.size(), 2U);
    EXPECT_EQ(scene.lights[0].kind, LightKind::directional);
    EXPECT_LT(scene.lights[0].direction.y, 0);
    EXPECT_EQ(scene.lights[1].kind, LightKind::point);
    const Aabb box = bounds(scene);
    EXPECT_LT(to_float(scene.lights[1].position).y, box.hi.y);
    EXPECT_GT(scene.groups.size(), 10U);
    std::size_t grouped = 0;
    for (const Group& group : scene.groups)
        grouped += group.count;
    EXPECT_EQ(grouped, scene.triangles.size());
}

} // namespace
} // namespace raywise
