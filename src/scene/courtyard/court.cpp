// What stands in the open court, and the ground under it.
#include "scene/courtyard/parts.hpp"
#include "scene/courtyard/plan.hpp"
#include "scene/mesh_builder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace raywise::courtyard {

using scene_detail::cosine_of_turns;
using scene_detail::ProfilePoint;

void add_pavement(MeshBuilder& mesh, const Counts& counts, std::uint64_t seed) {
    mesh.begin_group("pavement");
    const double ground = -0.06;
    const double reach_x = half_length + gallery;
    const double reach_z = half_width + gallery;
    mesh.add_quad(
        {-reach_x, ground, reach_z},
        {reach_x, ground, reach_z},
        {reach_x, ground, -reach_z},
        {-reach_x, ground, -reach_z}
    );
    const int columns = counts.paving * 3 / 2;
    const int rows = counts.paving;
    const double dx = 2 * half_length / columns;
    const double dz = 2 * half_width / rows;
    const double joint = 0.02 * dx;
    for (int row = 0; row < rows; ++row)
        for (int column = 0; column < columns; ++column) {
            // Each stone settled by up to a centimeter.
            Rng rng(
                seed, static_cast<std::uint64_t>(row) * 100'000U + static_cast<unsigned>(column)
            );
            const double x = -half_length + column * dx;
            const double z = -half_width + row * dz;
            mesh.add_box(
                {x + joint, ground, z + joint},
                {x + dx - joint, rng.uniform(-0.01, 0), z + dz - joint}
            );
        }
}

void add_fountain(MeshBuilder& mesh, const Counts& counts) {
    mesh.begin_group("fountain");
    const int turn = 2 * counts.turn;
    constexpr std::array<ProfilePoint, 9> basin{
        {{2.5, 0},
         {2.5, 0.12},
         {2.3, 0.14},
         {2.3, 0.6},
         {2.45, 0.65},
         {2.45, 0.75},
         {2.15, 0.75},
         {2.1, 0.2},
         {0, 0.2}}
    };
    mesh.add_lathe({}, basin, turn);
    constexpr std::array<ProfilePoint, 15> stem{
        {{0.6, 0.2},
         {0.6, 0.4},
         {0.35, 0.5},
         {0.22, 0.9},
         {0.3, 1.2},
         {0.25, 1.35},
         {0.5, 1.45},
         {1.1, 1.7},
         {1.15, 1.8},
         {1.05, 1.8},
         {0.5, 1.6},
         {0.15, 1.6},
         {0.12, 2.1},
         {0.2, 2.2},
         {0, 2.45}}
    };
    mesh.add_lathe({}, stem, turn);
    mesh.begin_group("water");
    std::vector<ProfilePoint> water;
    for (int i = 0; i <= counts.ripples; ++i) {
        const double radius = 2.15 * (counts.ripples - i) / counts.ripples;
        water.push_back({radius, 0.62 + 0.012 * cosine_of_turns(2.5 * radius)});
    }
    mesh.add_lathe({}, water, turn);
}

void add_tree(MeshBuilder& mesh, Vec3d foot, const Counts& counts, std::uint64_t seed) {
    constexpr std::array<ProfilePoint, 8> pot{
        {{0.35, 0},
         {0.4, 0.05},
         {0.5, 0.55},
         {0.56, 0.6},
         {0.56, 0.68},
         {0.48, 0.68},
         {0.45, 0.6},
         {0, 0.6}}
    };
    mesh.add_lathe(foot, pot, counts.turn);
    constexpr std::array<ProfilePoint, 4> trunk{{{0.08, 0.6}, {0.05, 1.2}, {0.045, 1.8}, {0, 2.3}}};
    mesh.add_lathe(foot, trunk, std::max(4, counts.turn / 2));
    const Vec3d middle = foot + Vec3d{0, 2.4, 0};
    for (int i = 0; i < counts.leaves; ++i) {
        Rng rng(seed, static_cast<std::uint64_t>(i));
        // A leaf near the surface of a ball, its three corners within a few centimeters.
        Vec3d spot;
        do
            spot = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
        while (dot(spot, spot) > 1 || dot(spot, spot) < 0.2);
        std::array<std::uint32_t, 3> corner{};
        for (std::uint32_t& index : corner)
            index = mesh.add_vertex(
                middle + spot * 0.9 +
                Vec3d{rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06), rng.uniform(-0.06, 0.06)}
            );
        mesh.add_triangle(corner[0], corner[1], corner[2]);
    }
}

} // namespace raywise::courtyard
