// The measures of the courtyard: its four sides, and how finely everything is made.
#pragma once

#include "scene/mesh_builder.hpp"

#include <raywise/geometry/vec.hpp>

#include <string>
#include <vector>

namespace raywise::courtyard {

using scene_detail::MeshBuilder;

inline constexpr double half_length = 12; ///< of the open court, along x
inline constexpr double half_width = 8;   ///< along z
inline constexpr double gallery = 3.5;    ///< depth of the arcades
inline constexpr double step = 0.15;      ///< height of the gallery floor above the pavement
inline constexpr double storey = 4.2;
inline constexpr double spring = 2.4;    ///< from a storey's floor to where its arches begin
inline constexpr double thickness = 0.5; ///< of the arcade walls
inline constexpr double eaves = step + 2 * storey;
inline constexpr double ridge = eaves + 1.6;

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

[[nodiscard]] std::vector<Side> sides();

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

    explicit Counts(double detail);
};

/// A box given by two corners in the coordinates of a side.
void add_box(MeshBuilder& mesh, const Side& side, Vec3d from, Vec3d to);

} // namespace raywise::courtyard
