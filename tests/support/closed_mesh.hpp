// Closed meshes with shared vertices: what a watertight query must not leak through.
#pragma once

#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <numbers>
#include <tuple>
#include <utility>
#include <vector>

namespace raywise::test_support {

struct ClosedMesh {
    std::vector<Vec3d> vertices;
    std::vector<std::array<std::uint32_t, 3>> corners;
};

/// The unit sphere from an icosahedron, each triangle cut in four `levels` times.
inline ClosedMesh icosphere(int levels) {
    const double g = std::numbers::phi;
    ClosedMesh mesh;
    for (const Vec3d& v :
         {Vec3d{-1, g, 0},
          Vec3d{1, g, 0},
          Vec3d{-1, -g, 0},
          Vec3d{1, -g, 0},
          Vec3d{0, -1, g},
          Vec3d{0, 1, g},
          Vec3d{0, -1, -g},
          Vec3d{0, 1, -g},
          Vec3d{g, 0, -1},
          Vec3d{g, 0, 1},
          Vec3d{-g, 0, -1},
          Vec3d{-g, 0, 1}})
        mesh.vertices.push_back(normalized(v));
    mesh.corners = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::uint32_t, std::uint32_t>, std::uint32_t> middles;
        const auto middle = [&](std::uint32_t a, std::uint32_t b) {
            const auto [at, is_new] = middles.try_emplace(
                std::minmax(a, b), static_cast<std::uint32_t>(mesh.vertices.size())
            );
            if (is_new) mesh.vertices.push_back(normalized(mesh.vertices[a] + mesh.vertices[b]));
            return at->second;
        };
        std::vector<std::array<std::uint32_t, 3>> finer;
        for (const auto& [a, b, c] : mesh.corners) {
            const std::uint32_t ab = middle(a, b);
            const std::uint32_t bc = middle(b, c);
            const std::uint32_t ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.corners = std::move(finer);
    }
    return mesh;
}

inline constexpr double torus_tube = 0.3;

/// Around z; its center circle has radius 1, its tube `torus_tube`.
inline ClosedMesh torus(std::uint32_t around, std::uint32_t across) {
    ClosedMesh mesh;
    for (std::uint32_t i = 0; i < around; ++i)
        for (std::uint32_t j = 0; j < across; ++j) {
            const double a = 2 * std::numbers::pi * i / around;
            const double b = 2 * std::numbers::pi * j / across;
            const double radius = 1 + torus_tube * std::cos(b);
            mesh.vertices.push_back(
                {radius * std::cos(a), radius * std::sin(a), torus_tube * std::sin(b)}
            );
            const auto at = [&](std::uint32_t k, std::uint32_t l) {
                return (k % around) * across + l % across;
            };
            mesh.corners.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            mesh.corners.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

/// The box [-1, 1]^3, each face cut into `cells` x `cells` squares: coplanar neighbors, edges
/// parallel to the axes.
inline ClosedMesh grid_box(std::uint32_t cells) {
    ClosedMesh mesh;
    std::map<std::tuple<std::uint32_t, std::uint32_t, std::uint32_t>, std::uint32_t> ids;
    const auto id = [&](std::array<std::uint32_t, 3> p) {
        const auto [at, is_new] = ids.try_emplace(
            std::tuple(p[0], p[1], p[2]), static_cast<std::uint32_t>(mesh.vertices.size())
        );
        if (is_new)
            mesh.vertices.push_back(
                {2.0 * p[0] / cells - 1, 2.0 * p[1] / cells - 1, 2.0 * p[2] / cells - 1}
            );
        return at->second;
    };
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (const std::uint32_t face : {0U, cells})
            for (std::uint32_t i = 0; i < cells; ++i)
                for (std::uint32_t j = 0; j < cells; ++j) {
                    const auto at = [&](std::uint32_t k, std::uint32_t l) {
                        std::array<std::uint32_t, 3> p{};
                        p[axis] = face;
                        p[(axis + 1) % 3] = k;
                        p[(axis + 2) % 3] = l;
                        return id(p);
                    };
                    mesh.corners.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
                    mesh.corners.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
                }
    return mesh;
}

} // namespace raywise::test_support
