// Area files written in full: every kind comes back number for number, and survives being damaged.
#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/io/area_file.hpp>
#include <raywise/io/files.hpp>
#include <raywise/io/ray_file.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <variant>
#include <vector>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;

constexpr Aabb scene_box{{0, 0, 0}, {10, 5, 8}};

const std::string every_kind = R"({"schema_version": 1, "areas": [
  {"name": "sun", "kind": "parallel", "direction": [0.3, -0.8, 0.5], "cone_half_angle_deg": 0.25},
  {"name": "lamp", "kind": "radial", "apex": [1, 3, 1], "region": {"kind": "box", "lo": [0, 0, 0], "hi": [4, 4, 4]}, "radius": 0.1,
   "affinity": {"angle_deg": 5, "distance": 0.5}},
  {"name": "plane", "kind": "plane", "point": [0, 0, 0], "normal": [0, 0, 1], "half_width": 2, "half_height": 1, "depth": 5},
  {"name": "point", "kind": "point", "eye": [0, 1, 0], "direction": [1, 0, 1], "fov_x_deg": 90, "fov_y_deg": 60, "near": 1, "far": 9,
   "emission": "yaw_pitch"},
  {"name": "seen", "kind": "measured", "rays": "rays.npy", "shrinkage": 2},
  {"name": "all", "kind": "uniform", "region": {"kind": "frustum", "eye": [0, 0, 0], "direction": [0, 0, 1], "roll_deg": 10,
   "fov_x_deg": 80, "fov_y_deg": 70, "far": 4}},
  {"name": "turned", "kind": "radial", "apex": [9, 9, 9], "density": 3,
   "region": {"kind": "obb", "center": [1, 1, 1], "direction": [1, 2, 3], "half": [1, 2, 3]}, "emission": "isotropic"}
]})";

class SavedAreas : public testing::Test {
protected:
    SavedAreas() {
        save_rays(
            folder_.path() / "rays.npy",
            std::vector<Ray>{{{1, 1, 1}, {0, 0, 1}, 0, 4}, {{2, 1, 1}, {0, 1, 0}}}
        );
    }

    std::vector<InfluenceArea> read(const std::string& text) {
        return load_areas(folder_.write("areas.json", text), scene_box);
    }

    std::string refusal_after(const std::string& what, const std::string& by) {
        std::string text = every_kind;
        const std::size_t at = text.find(what);
        EXPECT_NE(at, std::string::npos) << what;
        text.replace(at, what.size(), by);
        return refusal_of([&] { (void)read(text); }).value_or("accepted");
    }

    ScratchFolder folder_;
};

TEST_F(SavedAreas, ReadsEveryKindAsItsMakerMakesIt) {
    const std::vector<InfluenceArea> areas = read(every_kind);
    ASSERT_EQ(areas.size(), 7U);
    const InfluenceArea plane = InfluenceArea::plane(
        "plane",
        {.point = {0, 0, 0}, .normal = {0, 0, 1}, .half_width = 2, .half_height = 1, .depth = 5}
    );
    EXPECT_EQ(std::get<Obb>(areas[2].region).half, std::get<Obb>(plane.region).half);
    EXPECT_EQ(std::get<ParallelDistribution>(areas[2].distribution).params().half_width, 2);
    EXPECT_EQ(areas[0].name, "sun");
    EXPECT_EQ(
        std::get<ParallelDistribution>(areas[0].distribution).params().cone_half_angle_deg, 0.25
    );
    EXPECT_EQ(areas[1].affinity.distance, 0.5);
    EXPECT_EQ(
        std::get<RadialDistribution>(areas[1].distribution).params().emission, Emission::isotropic
    );
    EXPECT_EQ(
        std::get<RadialDistribution>(areas[3].distribution).params().emission, Emission::yaw_pitch
    );
    EXPECT_EQ(std::get<MeasuredDistribution>(areas[4].distribution).params().rays.size(), 2U);
    EXPECT_EQ(std::get<UniformDistribution>(areas[5].distribution).bounds(), scene_box);
    EXPECT_EQ(areas[6].density, 3);
    EXPECT_TRUE(read(R"({"schema_version": 1, "areas": []})").empty());
}

TEST_F(SavedAreas, ComesBackFromWritingNumberForNumber) {
    const std::vector<InfluenceArea> areas = read(every_kind);
    const std::filesystem::path path = folder_.path() / "saved.json";
    save_areas(path, areas);
    // Another scene's box: what was written depends on none.
    const std::vector<InfluenceArea> back = load_areas(path, {{-1, -1, -1}, {1, 1, 1}});
    ASSERT_EQ(back.size(), areas.size());
    const std::string text = read_file(path);
    save_areas(path, back);
    EXPECT_EQ(read_file(path), text);
    for (std::size_t i = 0; i < areas.size(); ++i) {
        EXPECT_EQ(back[i].region.index(), areas[i].region.index());
        EXPECT_EQ(back[i].distribution.index(), areas[i].distribution.index());
        for (std::uint64_t k = 0; k < 20; ++k) {
            Rng a(5, k);
            Rng b(5, k);
            const Ray expected = sample(areas[i].distribution, a);
            const Ray ray = sample(back[i].distribution, b);
            EXPECT_EQ(ray.origin, expected.origin) << areas[i].name;
            EXPECT_EQ(ray.direction, expected.direction) << areas[i].name;
        }
    }
}

TEST_F(SavedAreas, RefusesWhatItDoesNotKnowWithTheNearestKey) {
    EXPECT_THAT(refusal_after("\"direction\": [0.3", "\"directon\": [0.3"), HasSubstr("direct"));
    EXPECT_THAT(refusal_after("\"radius\"", "\"radios\""), HasSubstr("'radius'"));
    EXPECT_THAT(refusal_after("\"angle_deg\"", "\"angel_deg\""), HasSubstr("'angle_deg'"));
    EXPECT_THAT(refusal_after("\"shrinkage\"", "\"shrinkag\""), HasSubstr("'shrinkage'"));
    EXPECT_THAT(refusal_after("\"schema_version\"", "\"schema\""), HasSubstr("schema_version"));
    EXPECT_THAT(
        refusal_after("\"schema_version\": 1", "\"schema_version\": 2"), HasSubstr("schema_version")
    );
    EXPECT_THAT(refusal_after("\"kind\": \"plane\"", "\"kind\": \"plain\""), HasSubstr("plain"));
}

TEST_F(SavedAreas, RefusesValuesOutOfRangeAndOfOtherTypes) {
    for (const auto& [what, by] : std::vector<std::pair<std::string, std::string>>{
             {"[0.3, -0.8, 0.5]", "[0, 0, 0]"},
             {"[0.3, -0.8, 0.5]", "[0.3, -0.8]"},
             {"[0.3, -0.8, 0.5]", "[0.3, -0.8, \"x\"]"},
             {"[0.3, -0.8, 0.5]", "[0.3, -0.8, 1e999]"},
             {"\"hi\": [4, 4, 4]", "\"hi\": [-4, 4, 4]"},
             {"\"half_width\": 2", "\"half_width\": 0"},
             {"\"half_width\": 2", "\"half_width\": \"2\""},
             {"\"depth\": 5", "\"depth\": -5"},
             {"\"fov_x_deg\": 90", "\"fov_x_deg\": 180"},
             {"\"near\": 1", "\"near\": 10"},
             {"\"density\": 3", "\"density\": 0"},
             {"\"radius\": 0.1", "\"radius\": -1"},
             {"\"emission\": \"yaw_pitch\"", "\"emission\": \"yaw\""},
             {"\"name\": \"lamp\"", "\"name\": \"sun\""},
             {"\"name\": \"lamp\"", "\"name\": \"\""},
             {"\"name\": \"lamp\"", "\"name\": 7"},
             {"\"name\": \"lamp\"", "\"name\": \"a\", \"name\": \"b\""},
             {"rays.npy", "../rays.npy"},
             {"rays.npy", "missing.npy"},
             {"rays.npy", "areas.json"},
         })
        EXPECT_NE(refusal_after(what, by), "accepted") << by;
}

TEST_F(SavedAreas, SurvivesTruncationAndMutation) {
    EXPECT_TRUE(refusal_of([&] { (void)read(std::string(1'000'000, '[')); }));
    for (std::size_t size = 0; size < every_kind.size(); ++size)
        EXPECT_TRUE(refusal_of([&] { (void)read(every_kind.substr(0, size)); })) << size;
    EXPECT_GT(
        testing_io::refused_mutations(
            every_kind, 3000, [&](const std::string& text) { (void)read(text); }
        ),
        1000U
    );
}

} // namespace
} // namespace raywise
