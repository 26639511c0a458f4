// STL: both encodings, merging, and lengths that lie.
#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/io/files.hpp>
#include <raywise/io/load_scene.hpp>
#include <raywise/io/save_scene.hpp>
#include <raywise/scene/scene.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;

const std::string facet = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  "
                          "vertex 0 1 0\n endloop\nendfacet\n";
const std::string solid = "solid a part\n" + facet + facet + "endsolid a part\n";

class StlReader : public testing::Test {
protected:
    Scene read(const std::string& bytes, const LoadOptions& options = {}) {
        return load_scene(folder_.write("scene.stl", bytes), options, report_);
    }

    std::string refusal(const std::string& bytes) {
        return refusal_of([&] { (void)read(bytes); }).value_or("accepted");
    }

    /// Two triangles that share an edge, one vertex with a -0, as a binary file.
    std::string binary() {
        Scene scene;
        scene.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0F, 1, 0}, {1, 0, 0}, {1, 1, 0}};
        scene.triangles = {{0, 1, 2}, {3, 4, 5}};
        save_scene(folder_.path() / "binary.stl", scene);
        return read_file(folder_.path() / "binary.stl");
    }

    ScratchFolder folder_;
    LoadReport report_;
};

TEST_F(StlReader, MergesEqualVerticesOfBothEncodings) {
    const Scene text = read(solid);
    EXPECT_EQ(text.vertices.size(), 3U);
    EXPECT_EQ(text.triangles.size(), 2U);
    EXPECT_EQ(text.groups, (std::vector<Group>{{"a part", 0, 2}}));
    const Scene scene = read(binary());
    EXPECT_EQ(scene.vertices, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
    EXPECT_EQ(scene.triangles[1], (std::array<std::uint32_t, 3>{2, 1, 3}));
}

TEST_F(StlReader, TellsBinaryFilesThatBeginWithSolidByTheirLength) {
    std::string bytes = binary();
    bytes.replace(0, 5, "solid");
    EXPECT_EQ(read(bytes).triangles.size(), 2U);
}

TEST_F(StlReader, RefusesLengthsThatDoNotFit) {
    const std::string whole = binary();
    for (std::size_t size = 0; size < whole.size(); ++size)
        EXPECT_NE(refusal(whole.substr(0, size)), "accepted") << size;
    EXPECT_NE(refusal(whole + "x"), "accepted");
    std::string lying = whole;
    lying.replace(80, 4, "\xFF\xFF\xFF\xFF");
    EXPECT_THAT(refusal(lying), HasSubstr("4294967295 triangles need 214748364834 bytes"));
    EXPECT_THAT(refusal(whole.substr(0, 80) + std::string(4, '\0')), HasSubstr("no triangles"));
}

TEST_F(StlReader, RefusesCoordinatesThatAreNotFiniteOrDropsThem) {
    std::string bytes = binary();
    bytes.replace(84 + 12, 4, std::string("\0\0\x80\x7F", 4)); // +inf
    EXPECT_THAT(refusal(bytes), HasSubstr("byte 96: a coordinate is not finite"));
    EXPECT_EQ(read(bytes, {.skip_invalid = true}).triangles.size(), 1U);
    EXPECT_EQ(report_.dropped, 1U);
}

TEST_F(StlReader, RefusesMalformedTextWithItsLine) {
    const auto changed = [&](const std::string& what, const std::string& by) {
        std::string text = solid;
        return refusal(text.replace(text.find(what), what.size(), by));
    };
    EXPECT_THAT(changed("vertex 1 0 0", "vertex 1 0"), HasSubstr(":5: "));
    EXPECT_THAT(changed("vertex 1 0 0", "vertex 1 0 0 0"), HasSubstr(":5: "));
    EXPECT_THAT(changed("vertex 1 0 0", "vertex 1 0 0,5"), HasSubstr(":5: "));
    EXPECT_THAT(changed("vertex 1 0 0", "vertex 1 0 nan"), HasSubstr(":5: "));
    EXPECT_THAT(
        changed("vertex 1 0 0", "vertx 1 0 0"), HasSubstr(":5: 'vertx' where 'vertex' belongs")
    );
    EXPECT_THAT(changed(" endloop\n", ""), HasSubstr(":7: "));
    EXPECT_THAT(changed("outer loop", "outer\rloop"), HasSubstr(":3: "));
    EXPECT_THAT(refusal("solid\nendsolid\n"), HasSubstr("no triangles"));
    EXPECT_THAT(refusal("garbage"), HasSubstr(":1: "));
    for (std::size_t size = 0; size + 15 < solid.size(); ++size)
        EXPECT_NE(refusal(solid.substr(0, size)), "accepted") << size;
}

TEST_F(StlReader, SurvivesMutations) {
    for (const std::string& whole : {solid, binary()}) {
        const std::size_t refused =
            testing_io::refused_mutations(whole, 3000, [&](const std::string& bytes) {
                validate(read(bytes));
            });
        EXPECT_GT(refused, 500U);
        EXPECT_LT(refused, 3000U);
    }
}

} // namespace
} // namespace raywise
