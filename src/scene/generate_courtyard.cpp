// The courtyard: pavement, fountain, two storeys of arcades, tiled roofs, trees in pots. Everything
// scales with one number, the detail.
#include "mesh_builder.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/generate.hpp>
#include <raywise/scene/scene.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace raywise {

namespace {

using scene_detail::cosine_of_turns;
using scene_detail::MeshBuilder;
using scene_detail::ProfilePoint;
using scene_detail::scaled;
using scene_detail::sine_of_turns;

constexpr double half_length = 12; ///< of the open court, along x
constexpr double half_width = 8;   ///< along z
constexpr double gallery = 3.5;    ///< depth of the arcades
constexpr double step = 0.15;      ///< height of the gallery floor above the pavement
constexpr double storey = 4.2;
constexpr double spring = 2.4;    ///< from a storey's floor to where its arches begin
constexpr double thickness = 0.5; ///< of the arcade walls
constexpr double eaves = step + 2 * storey;
constexpr double ridge = eaves + 1.6;

/// One of the four sides, seen from the court: along its arcade, up, and into the court.
struct Side {
    std::string name;
    Vec3d corner; ///< left end of the arcade's court face, at y = 0
    Vec3d along;
    Vec3d inward;
    double length = 0;
    int bays = 0;

    [[nodiscard]] Vec3d at(double s, double y, double w) const {
        return corner + along * s + Vec3d{0, y, 0} + inward * w;
    }

    [[nodiscard]] double bay() const { return length / bays; }
};

std::vector<Side> sides() {
    return {
        {"north", {-half_length, 0, -half_width}, {1, 0, 0}, {0, 0, 1}, 2 * half_length, 8},
        {"south", {half_length, 0, half_width}, {-1, 0, 0}, {0, 0, -1}, 2 * half_length, 8},
        {"west", {-half_length, 0, half_width}, {0, 0, -1}, {1, 0, 0}, 2 * half_width, 5},
        {"east", {half_length, 0, -half_width}, {0, 0, 1}, {-1, 0, 0}, 2 * half_width, 5},
    };
}

/// Numbers of segments and of things at one detail: lines grow with its root, things with itself.
struct Counts {
    int arc;           ///< segments of an arch
    int turn;          ///< segments around a column
    int paving;        ///< stones across the court
    int tile_rows;     ///< roof tiles from eaves to ridge
    int tile_segments; ///< of a tile's bend
    int balusters;     ///< per bay
    int ripples;       ///< rings of the water
    int leaves;        ///< per tree
    int courses;       ///< of stone on the outer walls

    explicit Counts(double detail)
        : arc(scaled(14, std::sqrt(detail), 4))
        , turn(scaled(16, std::sqrt(detail), 5))
        , paving(scaled(20, std::sqrt(detail), 2))
        , tile_rows(scaled(8, std::cbrt(detail), 1))
        , tile_segments(scaled(4, std::cbrt(detail), 2))
        , balusters(scaled(5, std::cbrt(detail), 1))
        , ripples(scaled(14, std::sqrt(detail), 3))
        , leaves(scaled(2000, detail, 8))
        , courses(scaled(10, std::sqrt(detail), 1)) {}
};

/// A box given by two corners in the coordinates of a side.
void add_box(MeshBuilder& mesh, const Side& side, Vec3d from, Vec3d to) {
    const Vec3d a = side.at(from.x, from.y, from.z);
    const Vec3d b = side.at(to.x, to.y, to.z);
    mesh.add_box(min(a, b), max(a, b));
}

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

void add_column(MeshBuilder& mesh, const Side& side, double s, double floor, int turn) {
    const double radius = 0.17;
    const Vec3d foot = side.at(s, floor, -thickness / 2);
    const double half = 1.5 * radius;
    mesh.add_box(foot + Vec3d{-half, 0, -half}, foot + Vec3d{half, 0.18, half});
    // Base moldings, a shaft that swells and thins (entasis), the capital's bell.
    std::vector<ProfilePoint> profile{
        {1.4 * radius, 0.18},
        {1.45 * radius, 0.23},
        {1.2 * radius, 0.28},
        {1.25 * radius, 0.32},
        {radius, 0.36}
    };
    for (int i = 1; i <= 4; ++i) {
        const double u = i / 4.0;
        profile.push_back({radius * (1 + 0.06 * u - 0.22 * u * u), 0.36 + u * (spring - 0.86)});
    }
    for (const ProfilePoint point :
         {ProfilePoint{1.0 * radius, spring - 0.46},
          ProfilePoint{0.9 * radius, spring - 0.42},
          ProfilePoint{1.05 * radius, spring - 0.28},
          ProfilePoint{1.5 * radius, spring - 0.14}})
        profile.push_back(point);
    mesh.add_lathe(foot, profile, turn);
    mesh.add_box(
        foot + Vec3d{-1.1 * half, spring - 0.14, -1.1 * half},
        foot + Vec3d{1.1 * half, spring, 1.1 * half}
    );
}

/// The wall over one opening: two faces from the arc to the storey's top, and the arch's underside.
void add_arch(MeshBuilder& mesh, const Side& side, double middle, double floor, int arc) {
    const double half = side.bay() / 2;
    const double radius = half - 0.24;
    const double base = floor + spring;
    const double top = floor + storey;
    const auto on_arc = [&](double u, double w) {
        return side.at(
            middle - radius * cosine_of_turns(u / 2), base + radius * sine_of_turns(u / 2), w
        );
    };
    const auto face = [&](double u, double v, double w) {
        const Vec3d outline = side.at(middle + half * (2 * u - 1), top, w);
        return on_arc(u, w) * (1 - v) + outline * v;
    };
    const int rows = std::max(1, arc / 4);
    mesh.add_patch(arc, rows, [&](double u, double v) { return face(u, v, 0); });
    mesh.add_patch(arc, rows, [&](double u, double v) { return face(1 - u, v, -thickness); });
    mesh.add_patch(arc, 1, [&](double u, double v) { return on_arc(1 - u, -thickness * v); });
    // The strips over the two columns that the arc leaves open, and the undersides of those strips.
    for (const double end : {-1.0, 1.0}) {
        const auto at = [&](double s, double y, double w) {
            return side.at(middle + end * s, y, w);
        };
        for (const double w : {0.0, -thickness}) {
            const std::uint32_t a = mesh.add_vertex(at(half, base, w));
            const std::uint32_t b = mesh.add_vertex(at(radius, base, w));
            const std::uint32_t c = mesh.add_vertex(at(half, top, w));
            const bool is_turned = (end > 0) == (w == 0);
            if (is_turned)
                mesh.add_triangle(b, a, c);
            else
                mesh.add_triangle(a, b, c);
        }
        add_box(
            mesh,
            side,
            {middle + end * radius, base - 0.01, 0},
            {middle + end * half, base, -thickness}
        );
    }
    // An archivolt: a molding that stands out of the wall around the opening.
    const auto molding = [&](double u, double distance, double w) {
        return on_arc(u, w) + (on_arc(u, w) - side.at(middle, base, w)) * distance;
    };
    mesh.add_patch(arc, 1, [&](double u, double v) { return molding(u, 0.02 + 0.08 * v, 0.04); });
    mesh.add_patch(arc, 1, [&](double u, double v) { return molding(u, 0.10, 0.04 * (1 - v)); });
    mesh.add_patch(arc, 1, [&](double u, double v) { return molding(u, 0.02, 0.04 * v); });
}

void add_balustrade(MeshBuilder& mesh, const Side& side, double start, const Counts& counts) {
    const double floor = step + storey;
    const double middle = -thickness / 2;
    const double end = start + side.bay();
    add_box(
        mesh, side, {start + 0.2, floor, middle - 0.12}, {end - 0.2, floor + 0.1, middle + 0.12}
    );
    add_box(
        mesh,
        side,
        {start + 0.2, floor + 0.9, middle - 0.14},
        {end - 0.2, floor + 1.0, middle + 0.14}
    );
    constexpr std::array<ProfilePoint, 7> profile{
        {{0.06, 0.1},
         {0.045, 0.18},
         {0.075, 0.35},
         {0.07, 0.45},
         {0.035, 0.65},
         {0.04, 0.8},
         {0.06, 0.9}}
    };
    for (int i = 0; i < counts.balusters; ++i) {
        const double s = start + 0.3 + (side.bay() - 0.6) * (i + 0.5) / counts.balusters;
        mesh.add_lathe(side.at(s, floor, middle), profile, std::max(4, counts.turn / 2));
    }
}

void add_arcade(MeshBuilder& mesh, const Side& side, const Counts& counts) {
    for (int level = 0; level < 2; ++level) {
        mesh.begin_group(side.name + (level == 0 ? " arcade" : " loggia"));
        const double floor = step + level * storey;
        for (int bay = 0; bay < side.bays; ++bay) {
            const double start = bay * side.bay();
            add_column(mesh, side, start, floor, counts.turn);
            add_arch(mesh, side, start + side.bay() / 2, floor, counts.arc);
            if (level == 1) add_balustrade(mesh, side, start, counts);
        }
        // A cornice, and the floor of the gallery (with the corner on its left).
        add_box(mesh, side, {0, floor + storey - 0.12, 0}, {side.length, floor + storey, 0.1});
        add_box(
            mesh,
            side,
            {-gallery, floor - 0.15, level == 0 ? 0.25 : -thickness},
            {side.length, floor, -gallery}
        );
    }
}

/// The wall behind the gallery: a face, courses of stones in running bond, doors and windows.
void add_outer_wall(MeshBuilder& mesh, const Side& side, const Counts& counts, std::uint64_t seed) {
    mesh.begin_group(side.name + " wall");
    add_box(
        mesh,
        side,
        {-gallery - 0.4, -0.06, -gallery},
        {side.length + gallery, eaves + 1.6, -gallery - 0.4}
    );
    const double height = 1.2 / counts.courses;
    const double length = 2.5 * height;
    for (int course = 0; course < counts.courses; ++course) {
        const double y = step + course * height;
        double s = -gallery + ((course & 1) != 0 ? 0 : -length / 2);
        for (std::uint64_t stone = 0; s < side.length + gallery; ++stone, s += length) {
            Rng rng(seed, (static_cast<std::uint64_t>(course) << 32U) + stone);
            const double left = std::max(s + 0.03 * height, -gallery);
            const double right = std::min(s + length - 0.03 * height, side.length + gallery);
            if (right <= left) continue;
            add_box(
                mesh,
                side,
                {left, y + 0.03 * height, -gallery - 0.1},
                {right, y + 0.97 * height, -gallery + rng.uniform(0.02, 0.05)}
            );
        }
    }
    for (int level = 0; level < 2; ++level)
        for (int bay = 0; bay < side.bays; ++bay) {
            const double s = (bay + 0.5) * side.bay();
            const double floor = step + level * storey;
            const bool is_door = (bay + level) % 3 == 1;
            const double sill = floor + (is_door ? 0 : 1.3);
            const double lintel = floor + (is_door ? 2.3 : 2.5);
            for (const double jamb : {-0.6, 0.5})
                add_box(
                    mesh,
                    side,
                    {s + jamb, sill, -gallery - 0.1},
                    {s + jamb + 0.1, lintel, -gallery + 0.1}
                );
            add_box(
                mesh,
                side,
                {s - 0.7, lintel, -gallery - 0.1},
                {s + 0.7, lintel + 0.15, -gallery + 0.15}
            );
            add_box(
                mesh, side, {s - 0.5, sill, -gallery - 0.1}, {s + 0.5, lintel, -gallery + 0.02}
            );
        }
}

/// Half-round tiles in rows on a plane that falls from the outer wall to the court. Neighboring
/// sides meet along the hips: rows end where they do.
void add_roof(MeshBuilder& mesh, const Side& side, const Counts& counts) {
    mesh.begin_group(side.name + " roof");
    const double overhang = 0.5;
    const double depth = gallery + overhang;
    // v = 0 at the eaves over the court, 1 at the wall.
    const auto on_plane = [&](double s, double v, double lift) {
        return side.at(s, eaves + 0.05 + v * (ridge - eaves - 0.3) + lift, overhang - v * depth);
    };
    const auto first = [&](double v) { return overhang - v * depth; };
    const auto last = [&](double v) { return side.length - overhang + v * depth; };
    mesh.add_patch(1, 1, [&](double u, double v) {
        return on_plane(first(v) * (1 - u) + last(v) * u, v, 0);
    });
    mesh.add_patch(1, 1, [&](double u, double v) {
        return on_plane(first(v) * u + last(v) * (1 - u), v, -0.06);
    });
    const double row_depth = 1.0 / counts.tile_rows;
    const double width = 0.45 * depth * row_depth;
    const double radius = width / 2;
    for (int row = 0; row < counts.tile_rows; ++row) {
        const double v0 = row * row_depth;
        const double v1 = std::min(1.0, v0 + 1.1 * row_depth);
        for (double s = first(v0); s + width <= last(v0); s += width)
            mesh.add_patch(counts.tile_segments, 1, [&](double u, double v) {
                // Tiles taper upward, so that each lies under the one above it.
                const double r = radius * (1 - 0.15 * v);
                return on_plane(
                    s + radius - r * cosine_of_turns(u / 2),
                    v0 + (v1 - v0) * v,
                    r * sine_of_turns(u / 2) + 0.03 * (1 - v)
                );
            });
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
