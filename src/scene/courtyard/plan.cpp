#include "scene/courtyard/plan.hpp"
#include "scene/mesh_builder.hpp"

#include <raywise/geometry/vec.hpp>

#include <cmath>
#include <vector>

namespace raywise::courtyard {

using scene_detail::scaled;

std::vector<Side> sides() {
    return {
        {"north", {-half_length, 0, -half_width}, {1, 0, 0}, {0, 0, 1}, 2 * half_length, 8},
        {"south", {half_length, 0, half_width}, {-1, 0, 0}, {0, 0, -1}, 2 * half_length, 8},
        {"west", {-half_length, 0, half_width}, {0, 0, -1}, {1, 0, 0}, 2 * half_width, 5},
        {"east", {half_length, 0, -half_width}, {0, 0, 1}, {-1, 0, 0}, 2 * half_width, 5},
    };
}

Counts::Counts(double detail)
    : arc(scaled(14, std::sqrt(detail), 4))
    , turn(scaled(16, std::sqrt(detail), 5))
    , paving(scaled(20, std::sqrt(detail), 2))
    , tile_rows(scaled(8, std::cbrt(detail), 1))
    , tile_segments(scaled(4, std::cbrt(detail), 2))
    , balusters(scaled(5, std::cbrt(detail), 1))
    , ripples(scaled(14, std::sqrt(detail), 3))
    , leaves(scaled(2000, detail, 8))
    , courses(scaled(10, std::sqrt(detail), 1)) {}

void add_box(MeshBuilder& mesh, const Side& side, Vec3d from, Vec3d to) {
    const Vec3d a = side.at(from.x, from.y, from.z);
    const Vec3d b = side.at(to.x, to.y, to.z);
    mesh.add_box(min(a, b), max(a, b));
}

} // namespace raywise::courtyard
