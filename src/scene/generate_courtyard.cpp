// The courtyard: pavement, fountain, two storeys of arcades, tiled roofs, trees in pots. Everything
// scales with one number, the detail.
#include "scene/courtyard/parts.hpp"
#include "scene/courtyard/plan.hpp"
#include "scene/mesh_builder.hpp"

#include <raywise/geometry/frame.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <array>
#include <cstdint>

namespace raywise {

namespace {

using namespace courtyard;
using scene_detail::ProfilePoint;

void add_courtyard(MeshBuilder& mesh, double detail, std::uint64_t seed) {
    const Counts counts(detail);
    add_pavement(mesh, counts, seed);
    add_fountain(mesh, counts);
    std::uint64_t stream = seed;
    for (const Side& side : sides()) {
        add_arcade(mesh, side, counts);
        add_outer_wall(mesh, side, counts, ++stream);
        add_roof(mesh, side, counts);
    }
    mesh.begin_group("trees");
    for (const double x : {-6.0, 6.0})
        for (const double z : {-5.6, 5.6})
            add_tree(mesh, {x, 0, z}, counts, ++stream);
    mesh.begin_group("lamp");
    constexpr std::array<ProfilePoint, 4> shade{{{0, 0.1}, {0.05, 0.1}, {0.2, 0.0}, {0.18, 0.0}}};
    mesh.add_lathe({0, step + 3.35, -half_width - gallery / 2}, shade, counts.turn);
    mesh.end_group();
}

} // namespace

Scene generate_courtyard(const GenerateParams& params) {
    const auto build = [&](MeshBuilder& mesh, double detail) {
        add_courtyard(mesh, detail, params.seed);
    };
    Scene scene;
    scene.name = "courtyard";
    const double detail = scene_detail::fit_detail(params.triangles, build);
    MeshBuilder mesh(scene);
    build(mesh, detail);

    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::directional;
    sun.direction = {0.35, -0.8, -0.48};
    Light lamp;
    lamp.name = "lamp";
    lamp.kind = LightKind::point;
    lamp.position = {0, step + 3.2, -half_width - gallery / 2};
    lamp.range = 12;
    scene.lights = {sun, lamp};

    Camera camera;
    camera.name = "view";
    camera.eye = {11.2, 2.4, 5.2};
    camera.frame = frame_along({-0.86, 0.04, -0.5});
    camera.fov_x_rad = 1.3;
    camera.fov_y_rad = 0.92;
    camera.near = 0.1;
    camera.far = 60;
    scene.cameras = {camera};
    return scene;
}

} // namespace raywise
