// A city: blocks of houses of different heights along a grid of streets.
#include "scene/mesh_builder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <array>
#include <cmath>
#include <cstdint>

namespace raywise {

namespace {

using scene_detail::MeshBuilder;
using scene_detail::ProfilePoint;

constexpr double lot = 16;    ///< side of a house's lot, m
constexpr double street = 12; ///< width of a street
constexpr int lots = 3;       ///< lots along a side of a block
constexpr double floor_height = 3.2;

/// Frames and panes on one wall, from `corner` along `along`; `outward` is the wall's normal.
void add_windows(
    MeshBuilder& mesh,
    Vec3d corner,
    Vec3d along,
    Vec3d outward,
    int columns,
    int floors
) {
    for (int floor = 0; floor < floors; ++floor)
        for (int column = 0; column < columns; ++column) {
            const Vec3d middle = corner + along * ((column + 0.5) / columns) +
                                 Vec3d{0, (floor + 0.55) * floor_height, 0};
            const Vec3d half = abs(normalized(along)) * 0.55 + Vec3d{0, 0.8, 0};
            const Vec3d depth = abs(outward);
            mesh.add_box(middle - half - depth * 0.04, middle + half + depth * 0.04);
            const Vec3d sill = middle - Vec3d{0, 0.85, 0};
            const Vec3d reach = abs(normalized(along)) * 0.65 + Vec3d{0, 0.05, 0};
            mesh.add_box(sill - reach - depth * 0.02, sill + reach + depth * 0.15);
        }
}

/// A roof of two slopes and two gables over the walls' box.
void add_gabled_roof(MeshBuilder& mesh, Vec3d lo, Vec3d hi, double rise) {
    const double eave = 0.5;
    const double middle = (lo.z + hi.z) / 2;
    const double drop = rise * eave / (middle - lo.z);
    const Vec3d west{lo.x - eave, hi.y + rise, middle};
    const Vec3d east{hi.x + eave, hi.y + rise, middle};
    const double low = hi.y - drop;
    mesh.add_quad({lo.x - eave, low, hi.z + eave}, {hi.x + eave, low, hi.z + eave}, east, west);
    mesh.add_quad({hi.x + eave, low, lo.z - eave}, {lo.x - eave, low, lo.z - eave}, west, east);
    for (const bool is_east : {false, true}) {
        const double x = is_east ? hi.x : lo.x;
        const std::uint32_t a = mesh.add_vertex({x, hi.y, is_east ? hi.z : lo.z});
        const std::uint32_t b = mesh.add_vertex({x, hi.y, is_east ? lo.z : hi.z});
        const std::uint32_t c = mesh.add_vertex({x, hi.y + rise, middle});
        mesh.add_triangle(a, b, c);
    }
}

/// A parapet, a lift house and chimneys on a flat roof.
void add_flat_roof(MeshBuilder& mesh, Vec3d lo, Vec3d hi, Rng& rng) {
    const double rim = 0.3;
    mesh.add_box({lo.x, hi.y, lo.z}, {hi.x, hi.y + 0.9, lo.z + rim});
    mesh.add_box({lo.x, hi.y, hi.z - rim}, {hi.x, hi.y + 0.9, hi.z});
    mesh.add_box({lo.x, hi.y, lo.z + rim}, {lo.x + rim, hi.y + 0.9, hi.z - rim});
    mesh.add_box({hi.x - rim, hi.y, lo.z + rim}, {hi.x, hi.y + 0.9, hi.z - rim});
    const double x = rng.uniform(lo.x + 2, hi.x - 5);
    const double z = rng.uniform(lo.z + 2, hi.z - 5);
    mesh.add_box({x, hi.y, z}, {x + 3, hi.y + 2.6, z + 3});
    constexpr std::array<ProfilePoint, 4> vent{{{0.3, 0}, {0.3, 1.5}, {0.4, 1.6}, {0, 1.9}}};
    mesh.add_lathe({x - 1, hi.y, z - 1}, vent, 8);
}

void add_house(MeshBuilder& mesh, double x, double z, Rng& rng) {
    const double margin = rng.uniform(0.3, 2);
    const bool is_tower = rng.uniform_double() < 0.08;
    const int floors = 2 + static_cast<int>(rng.below(is_tower ? 14 : 4));
    const Vec3d lo{x + margin, 0, z + margin};
    const Vec3d hi{x + lot - margin, floors * floor_height, z + lot - margin};
    mesh.add_box(lo, hi);
    const int columns = 3 + static_cast<int>(rng.below(3));
    const Vec3d size = hi - lo;
    add_windows(mesh, {lo.x, 0, hi.z}, {size.x, 0, 0}, {0, 0, 1}, columns, floors);
    add_windows(mesh, {lo.x, 0, lo.z}, {size.x, 0, 0}, {0, 0, -1}, columns, floors);
    add_windows(mesh, {lo.x, 0, lo.z}, {0, 0, size.z}, {-1, 0, 0}, columns, floors);
    add_windows(mesh, {hi.x, 0, lo.z}, {0, 0, size.z}, {1, 0, 0}, columns, floors);
    if (!is_tower && rng.uniform_double() < 0.6)
        add_gabled_roof(mesh, lo, hi, rng.uniform(2, 4.5));
    else
        add_flat_roof(mesh, lo, hi, rng);
}

/// Where a lot begins on one axis: every `lots` lots a street.
double lot_start(int index) {
    const int streets = index / lots + 1;
    return index * lot + streets * street;
}

/// Houses fill the square of lots row by row; the last row may stay incomplete.
void add_city(MeshBuilder& mesh, int houses, std::uint64_t seed) {
    const int side = static_cast<int>(std::ceil(std::sqrt(static_cast<double>(houses))));
    const double extent = lot_start(side - 1) + lot + street;
    mesh.begin_group("ground");
    mesh.add_quad({0, 0, extent}, {extent, 0, extent}, {extent, 0, 0}, {0, 0, 0});
    mesh.begin_group("houses");
    for (int i = 0; i < houses; ++i) {
        Rng rng(seed, static_cast<std::uint64_t>(i));
        add_house(mesh, lot_start(i % side), lot_start(i / side), rng);
    }
    mesh.end_group();
}

} // namespace

Scene generate_city(const GenerateParams& params) {
    const auto build = [&](MeshBuilder& mesh, double detail) {
        add_city(mesh, scene_detail::scaled(100, detail, 1), params.seed);
    };
    Scene scene;
    scene.name = "city";
    const double detail = scene_detail::fit_detail(params.triangles, build);
    MeshBuilder mesh(scene);
    build(mesh, detail);

    Light sun;
    sun.name = "sun";
    sun.kind = LightKind::directional;
    sun.direction = {0.5, -0.6, 0.35};
    scene.lights = {sun};

    const double extent = static_cast<double>(bounds(scene).hi.x);
    Camera camera;
    camera.name = "view";
    camera.eye = {-0.15 * extent, 0.35 * extent + 20, 1.15 * extent};
    camera.frame = frame_along({0.65, -0.4, -0.65});
    camera.near = 1;
    camera.far = 4 * extent + 200;
    scene.cameras = {camera};
    return scene;
}

} // namespace raywise
