// Oracles: areas made by the makers of InfluenceArea from the same numbers, and texts with one
// fault each.
#include <raywise/io/area_file.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/io/ray_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <vector>

namespace raywise {
namespace {

using testing::HasSubstr;

const Aabb scene_bounds = {{-1, 0, -2}, {3, 4, 5}};

class LoadAreas : public testing::Test {
protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  (std::string("raywise_areas_") +
                   testing::UnitTest::GetInstance()->current_test_info()->name());
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    [[nodiscard]] std::filesystem::path path(const char* name) const { return folder_ / name; }

    [[nodiscard]] std::vector<InfluenceArea> load(const std::string& text) const {
        std::ofstream(path("areas.json")) << text;
        return load_areas(path("areas.json"), scene_bounds);
    }

    /// The areas of a file whose list is `areas`.
    [[nodiscard]] std::vector<InfluenceArea> load_list(const std::string& areas) const {
        return load(R"({"schema_version": 1, "areas": [)" + areas + "]}");
    }

    [[nodiscard]] std::string refusal(const std::string& areas) const {
        try {
            (void)load_list(areas);
        } catch (const Error& error) {
            return error.what();
        }
        return "no error";
    }

private:
    std::filesystem::path folder_;
};

/// Both give the same rays, so they are the same distribution.
void expect_same_rays(const InfluenceArea& a, const InfluenceArea& b) {
    for (std::uint64_t i = 0; i < 20; ++i) {
        Rng first(7, i), second(7, i);
        const Ray ray_a = sample(a.distribution, first), ray_b = sample(b.distribution, second);
        EXPECT_EQ(ray_a.origin, ray_b.origin);
        EXPECT_EQ(ray_a.direction, ray_b.direction);
    }
    EXPECT_EQ(bounds(a.region), bounds(b.region));
}

TEST_F(LoadAreas, ParallelWithoutARegionIsAroundTheScene) {
    const auto areas =
        load_list(R"({"name": "sun", "kind": "parallel", "direction": [0.3, -0.8, 0.5]})");
    ASSERT_EQ(areas.size(), 1U);
    EXPECT_EQ(areas[0].name, "sun");
    ParallelArea expected;
    expected.direction = {0.3, -0.8, 0.5};
    expected.region = obb_around(scene_bounds, expected.direction);
    expect_same_rays(areas[0], InfluenceArea::parallel("sun", expected));
}

TEST_F(LoadAreas, RadialInABoxWithAffinity) {
    const auto areas =
        load_list(R"({"name": "lamp", "kind": "radial", "apex": [0, 3, 0], "density": 2,
        "region": {"kind": "box", "lo": [-1, 0, -1], "hi": [1, 4, 1]},
        "affinity": {"angle_deg": 3, "distance": 0.5}})");
    ASSERT_EQ(areas.size(), 1U);
    RadialArea expected;
    expected.apex = {0, 3, 0};
    expected.region = Aabb{{-1, 0, -1}, {1, 4, 1}};
    expect_same_rays(areas[0], InfluenceArea::radial("lamp", expected));
    EXPECT_EQ(areas[0].density, 2);
    EXPECT_EQ(areas[0].affinity.angle_deg, 3);
    EXPECT_EQ(areas[0].affinity.distance, 0.5);
}

TEST_F(LoadAreas, PlaneAndPointAsInTheThesis) {
    const auto areas = load_list(
        R"({"name": "a", "kind": "plane", "point": [2, 1, 0], "normal": [-1, 0, 1], "half_width": 1.5,
            "half_height": 0.9, "depth": 10},
           {"name": "b", "kind": "point", "eye": [2, 1, 0], "direction": [-1, 0, 0], "fov_x_deg": 90,
            "fov_y_deg": 60, "near": 1, "far": 10, "emission": "yaw_pitch"})"
    );
    ASSERT_EQ(areas.size(), 2U);
    PlaneArea plane;
    plane.point = {2, 1, 0};
    plane.normal = {-1, 0, 1};
    plane.half_width = 1.5;
    plane.half_height = 0.9;
    plane.depth = 10;
    expect_same_rays(areas[0], InfluenceArea::plane("a", plane));
    PointArea point;
    point.eye = {2, 1, 0};
    point.direction = {-1, 0, 0};
    point.fov_y_deg = 60;
    point.near = 1;
    point.far = 10;
    point.emission = Emission::yaw_pitch;
    expect_same_rays(areas[1], InfluenceArea::point("b", point));
}

TEST_F(LoadAreas, OrientedBoxAndFrustumAsRegions) {
    const auto areas = load_list(
        R"({"name": "a", "kind": "parallel", "direction": [0, 0, 1], "region": {"kind": "obb", "center": [0, 0, 0],
            "direction": [0, 0, 1], "roll_deg": 90, "half": [1, 2, 3]}},
           {"name": "b", "kind": "radial", "apex": [0, 0, 0], "region": {"kind": "frustum", "eye": [0, 0, 0],
            "direction": [0, 0, 1], "fov_x_deg": 90, "fov_y_deg": 90, "near": 1, "far": 2}})"
    );
    ASSERT_EQ(areas.size(), 2U);
    const Aabb turned = bounds(areas[0].region); // the quarter turn swaps x and y
    EXPECT_NEAR(turned.hi.x, 2, 1e-5);
    EXPECT_NEAR(turned.hi.y, 1, 1e-5);
    EXPECT_NEAR(turned.hi.z, 3, 1e-5);
    EXPECT_TRUE(std::holds_alternative<Frustum>(areas[1].region));
}

TEST_F(LoadAreas, MeasuredRaysComeFromTheFolderOfTheFile) {
    const std::vector<Ray> rays = {{{0, 1, 0}, {0, 0, 1}}, {{1, 1, 0}, {0, 0, 1}}};
    save_rays(path("rays.npy"), rays);
    const auto areas = load_list(R"({"name": "m", "kind": "measured", "rays": "rays.npy"})");
    ASSERT_EQ(areas.size(), 1U);
    EXPECT_EQ(kind_name(areas[0].distribution), "measured");
    EXPECT_THAT(
        refusal(R"({"name": "m", "kind": "measured", "rays": "../rays.npy"})"), HasSubstr("folder")
    );
}

TEST_F(LoadAreas, AnEmptyListIsNoAreas) {
    EXPECT_TRUE(load_list("").empty());
}

TEST_F(LoadAreas, FaultsAreNamedWithFileAndArea) {
    EXPECT_THAT(
        refusal(R"({"name": "sun", "kind": "parallel", "dirction": [0, 0, 1]})"),
        testing::AllOf(
            HasSubstr("areas.json"), HasSubstr("area 'sun'"), HasSubstr("'dirction' meant")
        )
    );
    EXPECT_THAT(
        refusal(R"({"name": "sun", "kind": "parallel", "direction": [0, 0, 1], "densty": 1})"),
        HasSubstr("unknown key 'densty'; did you mean 'density'?")
    );
    EXPECT_THAT(
        refusal(R"({"name": "sun", "kind": "parallel", "direction": [0, 0, 0]})"),
        HasSubstr("areas.json")
    );
    EXPECT_THAT(
        refusal(R"({"name": "sun", "kind": "parallel", "direction": [0, 1]})"),
        HasSubstr("three numbers")
    );
    EXPECT_THAT(
        refusal(R"({"name": "sun", "kind": "parallel", "direction": [0, 1, "x"]})"),
        HasSubstr("three numbers")
    );
    EXPECT_THAT(refusal(R"({"name": "sun", "kind": "cosmic"})"), HasSubstr("kind 'cosmic'"));
    EXPECT_THAT(refusal(R"({"kind": "radial"})"), HasSubstr("area 1: 'name' is missing"));
    EXPECT_THAT(refusal("7"), HasSubstr("not a JSON object"));
    const std::string sun = R"({"name": "sun", "kind": "parallel", "direction": [0, 0, 1]})";
    EXPECT_THAT(refusal(sun + "," + sun), HasSubstr("two areas are named 'sun'"));
    EXPECT_THAT(
        refusal(R"({"name": "a", "name": "b", "kind": "parallel", "direction": [0, 0, 1]})"),
        HasSubstr("key 'name' is repeated")
    );
    EXPECT_THAT(
        refusal(R"({"name": "a", "kind": "parallel", "direction": [0, 0, 1e999]})"),
        HasSubstr("areas.json")
    );
}

TEST_F(LoadAreas, TextThatIsNoAreaFileIsRefused) {
    for (const char* text :
         {"",
          "[]",
          "{",
          "{\"areas\": []}",
          "{\"schema_version\": 2, \"areas\": []}",
          "{\"schema_version\": 1, \"areas\": {}}",
          "{\"schema_version\": 1, \"areas\": [], \"x\": 1}"})
        EXPECT_THROW((void)load(text), Error) << text;
    EXPECT_THROW((void)load_areas(path("missing.json"), scene_bounds), Error);
}

} // namespace
} // namespace raywise
