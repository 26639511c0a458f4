// What the doors of this layer refuse, in one wording.
#pragma once

#include <raywise/core/error.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>

#include <cmath>
#include <string>
#include <string_view>

namespace raywise {

inline void require(bool holds, std::string_view name, std::string_view rule) {
    if (!holds) throw Error(std::string(name).append(" must be ").append(rule));
}

inline void require_finite(Vec3d value, std::string_view name) {
    require(is_finite(value), name, "finite");
}

inline void require_positive(double value, std::string_view name) {
    require(std::isfinite(value) && value > 0, name, "finite and positive");
}

inline void require_not_negative(double value, std::string_view name) {
    require(std::isfinite(value) && value >= 0, name, "finite and not negative");
}

/// The frame as frame_along makes them: orthonormal within 1e-9, right-handed.
inline void require_orthonormal(const Frame& frame, std::string_view name) {
    constexpr double tolerance = 1e-9;
    const auto is_unit = [](Vec3d v) { return std::abs(dot(v, v) - 1) <= tolerance; };
    const Vec3d left_over = cross(frame.right, frame.up) - frame.forward;
    require(
        is_unit(frame.right) && is_unit(frame.up) && is_unit(frame.forward) &&
            dot(left_over, left_over) <= tolerance * tolerance,
        name,
        "orthonormal and right-handed"
    );
}

/// A box of which surface shares can be taken.
inline void require_surface(const Aabb& box, std::string_view name) {
    require(
        is_finite(box.lo) && is_finite(box.hi) && !box.is_empty(), name, "finite and not empty"
    );
    const float area = half_area(box);
    require(
        std::isfinite(area) && area > 0, name, "of a positive surface area within float's range"
    );
}

} // namespace raywise
