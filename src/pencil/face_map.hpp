// Where a point lies in a face.
#pragma once

#include "pencil/grid_data.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>

namespace raywise::pencil_detail {

/// Sets what queries use of a map whose other members are set.
inline void set_lanes(FaceMap& map, bool is_radial) {
    const auto column = [&](int axis) -> FaceMap::Lanes& {
        return map.columns[static_cast<std::size_t>(axis)];
    };
    const double depth = is_radial ? 0 : map.sign * map.depth_scale;
    map.columns = {};
    column(map.axis) = {-map.slope_u, -map.slope_v, depth, depth};
    column(map.axis_u)[0] = map.scale_u;
    column(map.axis_v)[1] = map.scale_v;
    map.columns[3] = {
        -map.offset_u,
        -map.offset_v,
        map.depth_offset + map.depth_slack,
        map.depth_offset - map.depth_slack
    };
    if (is_radial) map.dividend = {0, 0, -map.depth_scale, -map.depth_scale};
    constexpr double rounding_of_t = 0x1p-21;
    const double speed = is_radial ? 1 : static_cast<double>(map.speed) * map.depth_scale;
    const double less = speed * (1 - rounding_of_t);
    const double more = speed * (1 + rounding_of_t);
    map.toward = {0, 0, -less, -more};
    map.away = {0, 0, more, less};
    constexpr double infinity = std::numeric_limits<double>::infinity();
    const double range = is_radial ? infinity : map.reach * map.depth_scale;
    const double middle = is_radial ? 0 : map.depth_offset;
    map.least = {0, 0, middle - range, middle - range};
    map.limit = {map.size_u, map.size_v, middle + range, middle + range};
}

/// The nearest integer, ties to even, of an x below 2^51 in magnitude: without a call, as that of
/// the standard library is.
inline double nearest(double x) {
    constexpr double shift = 0x1.8p52;
    return (x + shift) - shift;
}

/// Unclamped. Monotone.
inline double depth_units_of(const FaceMap& map, double key) {
    return key * map.depth_scale + map.depth_offset;
}

/// Monotone. NaN is `deepest`.
inline std::int32_t limited_depth(double units) {
    const double limited = units < deepest ? units : double{deepest};
    return static_cast<std::int32_t>(limited > 0 ? limited : 0.0);
}

inline std::int32_t depth_units(const FaceMap& map, double key) {
    return limited_depth(depth_units_of(map, key));
}

} // namespace raywise::pencil_detail
