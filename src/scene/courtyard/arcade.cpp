#include "scene/courtyard/parts.hpp"
#include "scene/courtyard/plan.hpp"
#include "scene/mesh_builder.hpp"

#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace raywise::courtyard {

using scene_detail::cosine_of_turns;
using scene_detail::ProfilePoint;
using scene_detail::sine_of_turns;

namespace {

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

} // namespace

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

} // namespace raywise::courtyard
