#include "pencil/edge_lines.hpp"
#include "pencil/face_map.hpp"
#include "pencil/footprint.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/piece.hpp"
#include "pencil/records.hpp"

#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>

namespace raywise::pencil_detail {

namespace {

/// f(X, Y) = at + u X + v Y, for places (X, Y) in half cells from the middle, is within `error` of
/// a multiple of the distance from an edge.
struct Line {
    double u, v, at;
    double error;

    [[nodiscard]] Line operator-() const { return {-u, -v, -at, error}; }
};

/// The lines of the three edges, positive inside, when the triangle's turn is sure; its plane, too.
struct Lines {
    std::array<Line, 3> edges;
    DepthPlane depth;
    bool is_sure;
};

/// `error` as far as inputs are off; adds what the last operations rounded, from numbers up to
/// `largest`.
DepthPlane plane_of(double at, double u, double v, double error, double largest) {
    const double rounding = (largest + std::abs(at) + std::abs(u) + std::abs(v)) * 0x1p-46;
    return {at, u, v, error + rounding, error + rounding < 0x1p30};
}

double greatest(const Vec3d& v) {
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

/// With the barycentric weights e / area: depth = d0 + ((d1 - d0) e20 + (d2 - d0) e01) / area.
DepthPlane parallel_plane(
    const FaceMap& map,
    const std::array<Vec3d, 3>& p,
    const std::array<Line, 3>& edges,
    double area
) {
    const auto depth = [&](std::size_t i) {
        return depth_units_of(map, p[i][map.axis] * map.sign);
    };
    const double first = depth(0);
    const double rise_1 = (depth(1) - first) / area;
    const double rise_2 = (depth(2) - first) / area;
    // Edges are off by `error`, and weights of a place inside, which are at most 1, by as much of
    // the area.
    const double error = 4 * (std::abs(rise_1) + std::abs(rise_2)) * edges[0].error;
    return plane_of(
        first + rise_1 * edges[2].at + rise_2 * edges[0].at,
        rise_1 * edges[2].u + rise_2 * edges[0].u,
        rise_1 * edges[2].v + rise_2 * edges[0].v,
        error,
        std::abs(first) + std::abs(map.depth_offset) +
            (std::abs(rise_1 * edges[2].at) + std::abs(rise_2 * edges[0].at))
    );
}

/// Places in units from the middle of the window, each within `off`.
Lines parallel_lines(
    const FaceMap& map,
    const std::array<Vec3d, 3>& p,
    const Window& window,
    double off
) {
    const double half = window.side * 0.5;
    std::array<double, 3> x{}, y{};
    double size = half;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto place = [&](std::size_t lane) {
            return map.columns[0][lane] * p[i].x + map.columns[1][lane] * p[i].y +
                   map.columns[2][lane] * p[i].z + map.columns[3][lane];
        };
        x[i] = place(0) - (window.first_u + half);
        y[i] = place(1) - (window.first_v + half);
        size = std::max(size, std::max(std::abs(x[i]), std::abs(y[i])));
    }
    // Of a place, and of an edge's direction times what it is multiplied with, twice.
    const double error = 32 * (off + 0x1p-50 * size) * size;
    Lines lines{};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = i == 2 ? 0 : i + 1;
        const double along_x = x[j] - x[i];
        const double along_y = y[j] - y[i];
        lines.edges[i] = {-along_y * half, along_x * half, along_y * x[i] - along_x * y[i], error};
    }
    const double area = (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
    lines.is_sure = std::abs(area) > error;
    lines.depth = parallel_plane(map, p, lines.edges, area);
    if (area < 0)
        for (Line& line : lines.edges)
            line = -line;
    return lines;
}

/// The normals of the edges' planes add up to that of the triangle's: 1 / z = (e0 + e1 + e2) /
/// turn.
DepthPlane
radial_plane(const FaceMap& map, const std::array<Line, 3>& edges, double turn, double turn_error) {
    const auto [a, b, c] = edges;
    const double factor = -map.depth_scale / turn;
    const double at = factor * (a.at + b.at + c.at);
    const double u = factor * (a.u + b.u + c.u);
    const double v = factor * (a.v + b.v + c.v);
    const double size = std::abs(at) + std::abs(u) + std::abs(v);
    const double error = 2 * (std::abs(factor) * (a.error + b.error + c.error) +
                              size * (turn_error / std::abs(turn)));
    return plane_of(
        map.depth_offset + at,
        u,
        v,
        error,
        std::abs(map.depth_offset) +
            std::abs(factor) *
                (std::abs(a.at) + std::abs(b.at) + std::abs(c.at) + std::abs(a.u) + std::abs(b.u) +
                 std::abs(c.u) + std::abs(a.v) + std::abs(b.v) + std::abs(c.v))
    );
}

/// The planes through the apex and an edge, cut by the plane z = 1 of the face. So they are right
/// for triangles that reach behind the apex, too.
Lines radial_lines(
    const FaceMap& map,
    const std::array<Vec3d, 3>& p,
    const Vec3d& apex,
    const Window& window
) {
    const double half = window.side * 0.5;
    const double x = (window.first_u + half + map.offset_u) / map.scale_u;
    const double y = (window.first_v + half + map.offset_v) / map.scale_v;
    std::array<Vec3d, 3> q{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d seen = p[i] - apex;
        q[i] = {seen[map.axis_u], seen[map.axis_v], seen[map.axis] * map.sign};
    }
    Lines lines{};
    for (std::size_t i = 0; i < 3; ++i) {
        const Vec3d& a = q[i];
        const Vec3d& b = q[i == 2 ? 0 : i + 1];
        const Vec3d n = cross(a, b - a);
        lines.edges[i] = {
            n.x * (half / map.scale_u),
            n.y * (half / map.scale_v),
            n.x * x + n.y * y + n.z,
            0x1p-47 * greatest(a) * greatest(b)
        };
    }
    const double turn = dot(cross(q[0], q[1] - q[0]), q[2] - q[0]);
    const double turn_error = 0x1p-47 * greatest(q[0]) * greatest(q[1]) * greatest(q[2]);
    lines.is_sure = std::abs(turn) > turn_error;
    lines.depth = radial_plane(map, lines.edges, turn, turn_error);
    if (turn < 0)
        for (Line& line : lines.edges)
            line = -line;
    return lines;
}

/// The line in 16-bit numbers; returns the greatest value that it has in the cell.
///
/// Rounding the three numbers takes off at most 1/2 each, rounding the two products of a query as
/// much: 5/2 in all. A factor is chosen that leaves at most 5 for what the place and the line are
/// off: less than edge_doubt together.
int put(const Line& line, double place_error, std::int16_t* row) {
    constexpr double most = 16383;
    const double steep = std::max(std::abs(line.u), std::abs(line.v));
    const double change = std::abs(line.u) + std::abs(line.v);
    // The smaller one of most / steep and 5 / error, by one division.
    const double error = change * place_error + line.error;
    const bool is_steep = most * error <= 5 * steep;
    const double factor = (is_steep ? most : 5) / (is_steep ? steep : error);
    if (!(factor < 0x1p200)) {
        row[edge_u] = row[edge_v] = row[edge_at] = 0;
        return 0;
    }
    const double at = factor * line.at;
    // The whole cell is on one side.
    if (std::abs(at) > 2 * most + 1) {
        row[edge_u] = row[edge_v] = 0;
        row[edge_at] = static_cast<std::int16_t>(at > 0 ? 32767 : -32767);
        return row[edge_at];
    }
    row[edge_u] = static_cast<std::int16_t>(nearest(factor * line.u));
    row[edge_v] = static_cast<std::int16_t>(nearest(factor * line.v));
    row[edge_at] = static_cast<std::int16_t>(nearest(at));
    return row[edge_at] + std::abs(row[edge_u]) + std::abs(row[edge_v]);
}

constexpr std::array<std::int16_t, 3> everywhere{0, 0, 32767};

/// For a triangle whose turn is in doubt: the strip along its longest edge, whose two sides cannot
/// both be surely inside.
EdgeRows strip(const Lines& lines, double place_error) {
    const auto steepness = [](const Line& line) { return std::abs(line.u) + std::abs(line.v); };
    const Line& longest = *std::max_element(
        lines.edges.begin(),
        lines.edges.end(),
        [&](const Line& a, const Line& b) { return steepness(a) < steepness(b); }
    );
    EdgeRows rows{};
    (void)put(longest, place_error, rows.values.data());
    for (std::size_t k = 0; k < 3; ++k) {
        rows.values[3 + k] = static_cast<std::int16_t>(-rows.values[k]);
        rows.values[6 + k] = everywhere[k];
    }
    return rows;
}

/// Three lines around the bounds. With f = 8191 a half cell, they are u + v >= least_u + least_v,
/// u <= greatest_u and v <= greatest_v, each 7 - 3 outward for the roundings. Their values add up
/// to at most 27 - 12 + 9 where the bounds are small enough, and so cannot be surely inside.
EdgeRows box(const Footprint& bounds, const Window& window) {
    constexpr double factor = 8191;
    constexpr double outward = edge_doubt - 1 - 3;
    const double half = window.side * 0.5;
    const auto along = [&](std::int32_t unit, std::int32_t first) {
        return factor * ((unit - first) / half - 1);
    };
    const double least =
        along(bounds.least_u, window.first_u) + along(bounds.least_v, window.first_v);
    const double greatest_u = along(bounds.greatest_u, window.first_u);
    const double greatest_v = along(bounds.greatest_v, window.first_v);
    const auto number = [](double x) { return static_cast<std::int16_t>(nearest(x)); };
    const auto slope = static_cast<std::int16_t>(factor);
    return {
        {slope,
         slope,
         number(-least - outward),
         static_cast<std::int16_t>(-slope),
         0,
         number(greatest_u - outward),
         0,
         static_cast<std::int16_t>(-slope),
         number(greatest_v - outward)},
        false
    };
}

bool is_small(const Footprint& bounds, const Window& window) {
    const double wide = bounds.greatest_u - bounds.least_u;
    const double high = bounds.greatest_v - bounds.least_v;
    return (wide + high) * 8191 <= 27 * 0.5 * window.side;
}

} // namespace

EdgeLines::EdgeLines(
    const FaceMap& map,
    bool is_radial,
    const Records& records,
    Vec3d apex,
    double rounding
)
    : map_(map)
    , is_radial_(is_radial)
    , records_(records)
    , apex_(apex)
    , place_error_(rounding + 0.5) {
    // A place is a sum of four products, off by the roundings of the largest.
    for (std::size_t lane = 0; lane < 2; ++lane) {
        double largest = std::abs(map.columns[3][lane]);
        for (std::size_t axis = 0; axis < 3; ++axis)
            largest = std::max(largest, std::abs(map.columns[axis][lane]) * records.greatest());
        off_ = std::max(off_, 0x1p-49 * largest);
    }
}

/// With what places are off added to the error.
///
/// A ray toward an apex may stray, as its direction is rounded: by stray_share * reach * t / z, as
/// a slope, where it has gone the share t of its way and z is left of it. With s = (|slope_u| +
/// |slope_v|) * stray_share * reach in depths per slope, it meets the triangle within s t / z of
/// the plane's depth at its place. That is less than what lies between there and its end at t_min,
/// depth_scale / z0 * (t - t_min) / ((1 - t) (1 - t_min)), but near t_min: so, if s is at most a
/// quarter of depth_scale, twice what it strays at t_min is enough, and that is half a unit at
/// most, see FaceMap::most_t.
DepthPlane EdgeLines::found_by_place(const DepthPlane& plane, const Window& window) const {
    const double half = window.side * 0.5;
    const double strays = (std::abs(plane.u) * map_.scale_u + std::abs(plane.v) * map_.scale_v) /
                          half * (stray_share * map_.reach);
    DepthPlane found = plane;
    // Places are rounded down to units.
    const double steps = (plane.u + plane.v) / half;
    found.at += 0.5 * steps;
    found.error += (std::abs(plane.u) + std::abs(plane.v)) / half * (0.5 + place_error_);
    found.is_known = plane.is_known && (!is_radial_ || strays <= map_.depth_scale / 4);
    return found;
}

SeenTriangle
EdgeLines::see(const Piece& piece, const Footprint& bounds, const Window& window) const {
    const std::array<Vec3d, 3> vertices{
        records_.vertex(piece.prim, 0),
        records_.vertex(piece.prim, 1),
        records_.vertex(piece.prim, 2)
    };
    const Lines lines = is_radial_ ? radial_lines(map_, vertices, apex_, window)
                                   : parallel_lines(map_, vertices, window, off_);
    const double place_error = piece.margin / (window.side * 0.5);
    // The bounds of a part say nothing of the other parts.
    if (!lines.is_sure)
        return {
            !piece.is_part && is_small(bounds, window) ? box(bounds, window)
                                                       : strip(lines, place_error),
            {}
        };
    EdgeRows rows{};
    for (std::size_t i = 0; i < 3; ++i) {
        const int most = put(lines.edges[i], place_error, rows.values.data() + 3 * i);
        rows.is_missed = rows.is_missed || most <= -edge_doubt;
    }
    return {rows, found_by_place(lines.depth, window)};
}

} // namespace raywise::pencil_detail
