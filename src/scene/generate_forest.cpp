// A forest: trees of trunks, branches and single leaves on uneven ground.
#include "scene/mesh_builder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

namespace raywise {

namespace {

using scene_detail::MeshBuilder;
using scene_detail::ProfilePoint;
using scene_detail::sine_of_turns;

constexpr int leaves_per_branch = 60;
constexpr double spacing = 5; ///< m between trees

double ground_height(double x, double z) {
    return 1.2 * sine_of_turns(x / 61) * sine_of_turns(z / 47) +
           0.3 * sine_of_turns((x + 2 * z) / 23);
}

/// A point uniform in the unit ball.
Vec3d in_ball(Rng& rng) {
    Vec3d point;
    do
        point = {rng.uniform(-1, 1), rng.uniform(-1, 1), rng.uniform(-1, 1)};
    while (dot(point, point) > 1);
    return point;
}

/// A leaf: a rhombus of two triangles at any slant, about 40 cm long.
void add_leaf(MeshBuilder& mesh, Vec3d at, Rng& rng) {
    const Vec3d along = in_ball(rng) * 0.3;
    const Vec3d across = in_ball(rng) * 0.15;
    mesh.add_quad(at - along, at + across, at + along, at - across);
}

/// A three-sided tapered stick from `from` to `to`.
void add_branch(MeshBuilder& mesh, Vec3d from, Vec3d to, double radius) {
    const Frame frame = frame_along(to - from);
    std::array<Vec3d, 3> offset{};
    for (std::size_t k = 0; k < 3; ++k) {
        const double turn = static_cast<double>(k) / 3;
        offset[k] = frame.right * (radius * scene_detail::cosine_of_turns(turn)) +
                    frame.up * (radius * sine_of_turns(turn));
    }
    for (std::size_t k = 0; k < 3; ++k) {
        const Vec3d a = offset[k];
        const Vec3d b = offset[(k + 1) % 3];
        mesh.add_quad(from + b, from + a, to + a * 0.3, to + b * 0.3);
    }
}

void add_tree(MeshBuilder& mesh, Vec3d foot, Rng& rng) {
    const double height = rng.uniform(6, 14);
    const double girth = height * 0.02;
    const std::array<ProfilePoint, 5> trunk{
        {{1.6 * girth, -0.5},
         {girth, 0.5},
         {0.8 * girth, 0.5 * height},
         {0.3 * girth, 0.9 * height},
         {0, height}}
    };
    mesh.add_lathe(foot, trunk, 7);
    const int branches = 5 + static_cast<int>(rng.below(6));
    for (int i = 0; i < branches; ++i) {
        const double level = rng.uniform(0.35, 0.95);
        const double reach = 0.35 * height * (1.1 - level);
        const Vec3d from = foot + Vec3d{0, level * height, 0};
        const double turn = rng.uniform_double();
        const Vec3d to = from + Vec3d{
                                    reach * scene_detail::cosine_of_turns(turn),
                                    reach * rng.uniform(0.2, 0.7),
                                    reach * sine_of_turns(turn)
                                };
        add_branch(mesh, from, to, 0.4 * girth);
        for (int leaf = 0; leaf < leaves_per_branch; ++leaf)
            add_leaf(mesh, from * 0.3 + to * 0.7 + in_ball(rng) * (0.6 * reach), rng);
    }
}

void add_forest(MeshBuilder& mesh, int trees, std::uint64_t seed) {
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(trees))));
    const double extent = side * spacing;
    mesh.begin_group("ground");
    const int cells = 2 * side;
    mesh.add_patch(cells, cells, [&](double u, double v) {
        const double x = (u * 1.2 - 0.1) * extent;
        const double z = (1.1 - v * 1.2) * extent;
        return Vec3d{x, ground_height(x, z), z};
    });
    mesh.begin_group("trees");
    for (int i = 0; i < trees; ++i) {
        Rng rng(seed, static_cast<std::uint64_t>(i));
        const int column = i % side;
        const int row = i / side;
        const double x = (column + rng.uniform_double()) * spacing;
        const double z = (row + rng.uniform_double()) * spacing;
        add_tree(mesh, {x, ground_height(x, z), z}, rng);
    }
    mesh.end_group();
}

} // namespace

Scene generate_forest(const GenerateParams& params) {
    const auto build = [&](MeshBuilder& mesh, double detail) {
        add_forest(mesh, scene_detail::scaled(100, detail, 1), params.seed);
    };
    Scene scene;
    scene.name = "forest";
    const double detail = scene_detail::fit_detail(params.triangles, build);
    MeshBuilder mesh(scene);
    build(mesh, detail);

    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::directional;
    sun.direction = {-0.4, -0.7, 0.2};
    scene.lights = {sun};

    const double extent = static_cast<double>(bounds(scene).hi.x);
    Camera camera;
    camera.name = "view";
    camera.eye = {0.5 * extent, 0.25 * extent + 8, 1.4 * extent + 5};
    camera.frame = frame_along({0, -0.25, -1});
    camera.near = 0.1;
    camera.far = 4 * extent + 100;
    scene.cameras = {camera};
    return scene;
}

} // namespace raywise
