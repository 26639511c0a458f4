// What encloses the galleries.
#include "scene/courtyard/parts.hpp"
#include "scene/courtyard/plan.hpp"
#include "scene/mesh_builder.hpp"

#include <raywise/core/rng.hpp>

#include <algorithm>
#include <cstdint>

namespace raywise::courtyard {

using scene_detail::cosine_of_turns;
using scene_detail::sine_of_turns;

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

} // namespace raywise::courtyard
