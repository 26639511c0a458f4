// Where a point lies in a face: the one function that queries and the build share.
#pragma once

#include "pencil/grid_data.hpp"

#include <algorithm>
#include <cstdint>

namespace raywise::pencil_detail {

/// Units across and depth of a point, unclamped.
struct Place {
    double u;
    double v;
    double z; ///< depth in scene units
};

inline Place parallel_place(const FaceMap& map, double x_u, double x_v, double x_axis) {
    return {
        x_u * map.scale_u - x_axis * map.slope_u - map.offset_u,
        x_v * map.scale_v - x_axis * map.slope_v - map.offset_v,
        x_axis * map.sign,
    };
}

/// For a point as seen from the apex, or a direction; z > 0.
inline Place radial_place(const FaceMap& map, double x_u, double x_v, double x_axis) {
    const double z = x_axis * map.sign;
    const double inverse = 1 / z;
    return {
        x_u * inverse * map.scale_u - map.offset_u,
        x_v * inverse * map.scale_v - map.offset_v,
        z,
    };
}

/// Unclamped. Monotone in z.
inline double depth_units_of(const FaceMap& map, double z) {
    return z * map.depth_scale + map.depth_offset;
}

/// Monotone. NaN is `deepest`.
inline std::int32_t limited_depth(double units) {
    const double limited = units < deepest ? units : double{deepest};
    return static_cast<std::int32_t>(limited > 0 ? limited : 0.0);
}

inline std::int32_t depth_units(const FaceMap& map, double z) {
    return limited_depth(depth_units_of(map, z));
}

} // namespace raywise::pencil_detail
