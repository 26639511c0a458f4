#include <raywise/geometry/triangle_view.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise {
namespace {

TEST(TriangleView, OfNothingHasNoTriangles) {
    EXPECT_EQ(TriangleView().size(), 0U);
}

TEST(TriangleView, ReadsAnInterleavedMeshInPlace) {
    struct Vertex {
        std::array<float, 3> normal;
        std::array<float, 3> position;
    };
    struct Face {
        std::uint32_t material;
        std::array<std::uint32_t, 3> corner;
    };
    std::vector<Vertex> vertices;
    for (int i = 0; i < 4; ++i) {
        const auto x = static_cast<float>(i);
        vertices.push_back({{9, 9, 9}, {x, x * x, 1}});
    }
    const std::vector<Face> faces{{7, {0, 1, 2}}, {8, {3, 2, 1}}};
    const TriangleView view(
        vertices[0].position.data(),
        sizeof(Vertex),
        faces[0].corner.data(),
        sizeof(Face),
        faces.size()
    );
    EXPECT_EQ(view[PrimId{1}], (Triangle{{3, 9, 1}, {2, 4, 1}, {1, 1, 1}}));
    vertices[3].position[0] = -5; // the caller's change is seen: nothing was copied
    EXPECT_EQ(view[PrimId{1}].v0, (Vec3{-5, 9, 1}));
}

} // namespace
} // namespace raywise
