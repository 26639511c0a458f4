#include <raywise/analysis/end_point_overlap.hpp>

#include <raywise/build/binned.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace raywise {
namespace {

struct Mesh {
    std::vector<Vec3> vertices;
    std::vector<std::array<std::uint32_t, 3>> triangles;

    void add(Vec3 a, Vec3 b, Vec3 c) {
        const auto first = static_cast<std::uint32_t>(vertices.size());
        vertices.insert(vertices.end(), {a, b, c});
        triangles.push_back({first, first + 1, first + 2});
    }

    [[nodiscard]] TriangleView view() const { return {vertices, triangles}; }
};

/// A root over two leaves of one primitive each.
Bvh pair_of(const Aabb& left, const Aabb& right) {
    Bvh tree;
    tree.nodes = {
        Node::inner(unite(left, right), NodeId{1}), Node::leaf(left, 0, 1), Node::leaf(right, 1, 1)
    };
    tree.prims = {PrimId{0}, PrimId{1}};
    return tree;
}

TEST(EndPointOverlap, OfNothingIsZero) {
    EXPECT_EQ(measure_end_point_overlap(Bvh{}, TriangleView{}), 0);
    EXPECT_EQ(measure_end_point_overlap(Bvh{}, std::span<const EndPoint>{}), 0);
}

TEST(EndPointOverlap, OfTrianglesWithoutAreaIsZero) {
    Mesh mesh;
    mesh.add({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
    mesh.add({0, 0, 0}, {0, 0, 0}, {0, 0, 0});
    const Bvh tree = pair_of({{0, 0, 0}, {2, 2, 2}}, {{0, 0, 0}, {0, 0, 0}});
    EXPECT_EQ(measure_end_point_overlap(tree, mesh.view()), 0);
}

TEST(EndPointOverlap, OfSeparateBoxesIsZero) {
    Mesh mesh;
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    mesh.add({3, 0, 0}, {4, 0, 0}, {3, 1, 0});
    const Bvh tree = pair_of(bounds(mesh.view()[PrimId{0}]), bounds(mesh.view()[PrimId{1}]));
    EXPECT_EQ(measure_end_point_overlap(tree, mesh.view()), 0);
}

TEST(EndPointOverlap, CountsTheForeignPartWorkedOutByHand) {
    Mesh mesh;
    // Areas 2 and 0.5. The first covers all of the second's box, the unit square; the second lies
    // wholly in the first's.
    mesh.add({0, 0, 0}, {2, 0, 0}, {0, 2, 0});
    mesh.add({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const Bvh tree = pair_of(bounds(mesh.view()[PrimId{0}]), bounds(mesh.view()[PrimId{1}]));
    EXPECT_NEAR(measure_end_point_overlap(tree, mesh.view()), 1.2 * (0.5 + 1.0) / 2.5, 1e-12);
}

TEST(EndPointOverlap, OwnPointsAreFreeAndForeignOnesCost) {
    const Bvh tree = pair_of({{0, 0, 0}, {2, 1, 1}}, {{1, 0, 0}, {3, 1, 1}});
    const std::array points{
        EndPoint{{1.5F, 0.5F, 0.5F}, PrimId{0}}, // also in the other's box
        EndPoint{{0.5F, 0.5F, 0.5F}, PrimId{0}}, // only in its own
        EndPoint{{2.5F, 0.5F, 0.5F}, no_prim},   // foreign to the leaf and to the root
        EndPoint{{9, 9, 9}, no_prim},            // outside of everything
    };
    EXPECT_NEAR(measure_end_point_overlap(tree, points), (1.2 + (1.2 + 2)) / 4, 1e-12);
}

TEST(EndPointOverlap, OfSurfaceIsTheLimitOfThatOfUniformPointsOnIt) {
    Mesh mesh;
    Rng rng(7);
    const auto coordinate = [&] { return rng.uniform(); };
    for (int i = 0; i < 4; ++i) {
        mesh.add(
            {coordinate(), coordinate(), coordinate()},
            {coordinate(), coordinate(), coordinate()},
            {coordinate(), coordinate(), coordinate()}
        );
    }
    std::array<Aabb, 4> box;
    std::array<double, 4> sums{};
    double total = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Triangle t = mesh.view()[to_prim(i)];
        box[i] = bounds(t);
        total += static_cast<double>(length(cross(t.v1 - t.v0, t.v2 - t.v0)));
        sums[i] = total;
    }
    Bvh tree;
    const Aabb left = unite(box[0], box[1]);
    const Aabb right = unite(box[2], box[3]);
    tree.nodes = {
        Node::inner(unite(left, right), NodeId{1}),
        Node::inner(left, NodeId{3}),
        Node::inner(right, NodeId{5}),
        Node::leaf(box[0], 0, 1),
        Node::leaf(box[1], 1, 1),
        Node::leaf(box[2], 2, 1),
        Node::leaf(box[3], 3, 1)
    };
    tree.prims = {PrimId{0}, PrimId{1}, PrimId{2}, PrimId{3}};
    std::vector<EndPoint> points;
    for (int i = 0; i < 200'000; ++i) {
        const double pick = rng.uniform_double() * total;
        std::size_t id = 0;
        while (id < 3 && sums[id] < pick)
            ++id;
        float u = rng.uniform();
        float v = rng.uniform();
        if (u + v > 1) {
            u = 1 - u;
            v = 1 - v;
        }
        const Triangle t = mesh.view()[to_prim(id)];
        points.push_back({t.v0 + (t.v1 - t.v0) * u + (t.v2 - t.v0) * v, to_prim(id)});
    }
    const double exact = measure_end_point_overlap(tree, mesh.view());
    EXPECT_GT(exact, 0.1);
    EXPECT_NEAR(measure_end_point_overlap(tree, points), exact, 0.02 * exact);
}

TEST(EndPointOverlap, OfEveryKthTriangleIsNearThatOfAll) {
    Mesh mesh;
    std::vector<Aabb> boxes;
    for (std::uint64_t i = 0; i < 2000; ++i) {
        Rng rng(3, i);
        const auto coordinate = [&] { return rng.uniform(); };
        const Vec3 corner{coordinate(), coordinate(), coordinate()};
        const auto beside = [&] {
            return corner + Vec3{coordinate(), coordinate(), coordinate()} * 0.2F;
        };
        mesh.add(corner, beside(), beside());
        boxes.push_back(bounds(mesh.view()[to_prim(i)]));
    }
    const Bvh tree = build_binned(boxes, SurfaceMeasure{});
    const auto measure = [&](std::size_t most) {
        return measure_end_point_overlap(tree, mesh.view(), {}, serial_executor(), most);
    };
    const double all = measure(2000);
    EXPECT_EQ(measure(1'000'000), all);
    EXPECT_NE(measure(1000), all) << "a sample";
    EXPECT_NEAR(measure(1000), all, 0.1 * all);
    EXPECT_GE(measure(1), 0);
}

} // namespace
} // namespace raywise
