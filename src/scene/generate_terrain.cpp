// A terrain: a height field of summed value noise.
#include "scene/mesh_builder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <cmath>
#include <cstdint>

namespace raywise {

namespace {

using scene_detail::MeshBuilder;

constexpr double extent = 1000; ///< m
constexpr int octaves = 8;

/// Random heights on the integer grid, blended smoothly in between; in [0, 1).
double value_noise(std::uint64_t seed, double x, double z) {
    const double column = std::floor(x);
    const double row = std::floor(z);
    const auto corner = [&](int dx, int dz) {
        const auto stream =
            (static_cast<std::uint64_t>(column + dx) << 32U) + static_cast<std::uint64_t>(row + dz);
        return Rng(seed, stream).uniform_double();
    };
    const auto smooth = [](double t) { return t * t * (3 - 2 * t); };
    const double u = smooth(x - column);
    const double v = smooth(z - row);
    const double near = corner(0, 0) * (1 - u) + corner(1, 0) * u;
    const double far = corner(0, 1) * (1 - u) + corner(1, 1) * u;
    return near * (1 - v) + far * v;
}

/// Ridges: the folded noise of ever finer octaves, each of half the height.
double height(std::uint64_t seed, double u, double v) {
    double sum = 0;
    double size = 160;
    double frequency = 3;
    for (int octave = 0; octave < octaves; ++octave) {
        const double noise =
            value_noise(seed + static_cast<std::uint64_t>(octave), u * frequency, v * frequency);
        sum += size * (1 - std::abs(2 * noise - 1));
        size /= 2.1;
        frequency *= 2;
    }
    return sum;
}

} // namespace

Scene generate_terrain(const GenerateParams& params) {
    const auto build = [&](MeshBuilder& mesh, double detail) {
        const int cells = scene_detail::scaled(200, std::sqrt(detail), 1);
        mesh.begin_group("ground");
        mesh.add_patch(cells, cells, [&](double u, double v) {
            return Vec3d{extent * u, height(params.seed, u, v), extent * (1 - v)};
        });
        mesh.end_group();
    };
    Scene scene;
    scene.name = "terrain";
    const double detail = scene_detail::fit_detail(params.triangles, build);
    MeshBuilder mesh(scene);
    build(mesh, detail);

    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::directional;
    sun.direction = {0.7, -0.35, -0.2};
    scene.lights = {sun};

    Camera camera;
    camera.name = "view";
    camera.eye = {500, 650, 1500};
    camera.frame = frame_along({0, -0.5, -1});
    camera.near = 1;
    camera.far = 5000;
    scene.cameras = {camera};
    return scene;
}

} // namespace raywise
