// The outline of an axis-aligned box, by where it is seen from. The table is that of
// [Schmalstieg99].
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace raywise {

/// Where a box is seen from: per axis -1 below the box, +1 above it, 0 within its slab; packed as
/// 9 (x + 1) + 3 (y + 1) + (z + 1), in [0, 26]. 13 is the inside.
enum class ViewCode : std::uint8_t {};

inline constexpr ViewCode view_inside{13};

[[nodiscard]] constexpr ViewCode to_view_code(int x, int y, int z) {
    return static_cast<ViewCode>(9 * (x + 1) + 3 * (y + 1) + z + 1);
}

/// Vertex ids (Aabb::vertex) of the outline, counter-clockwise to the viewer: none from inside,
/// four when one face is seen, else six.
struct Silhouette {
    std::size_t size = 0;
    std::array<std::uint8_t, 6> vertices{};
};

/// The view of a nonempty box from a point. A point in a face plane is within that slab.
[[nodiscard]] constexpr ViewCode view_from(const Aabb& box, Vec3d eye) {
    const auto side = [](double e, double lo, double hi) { return e < lo ? -1 : e > hi ? 1 : 0; };
    const Vec3d lo = to_double(box.lo);
    const Vec3d hi = to_double(box.hi);
    return to_view_code(side(eye.x, lo.x, hi.x), side(eye.y, lo.y, hi.y), side(eye.z, lo.z, hi.z));
}

/// The view of any box by parallel rays along `direction`; zero components are tested exactly.
[[nodiscard]] constexpr ViewCode view_along(Vec3d direction) {
    const auto side = [](double d) { return d > 0 ? -1 : d < 0 ? 1 : 0; };
    return to_view_code(side(direction.x), side(direction.y), side(direction.z));
}

/// The outline for a view. Exact for a point view when all vertices are in front of the image
/// plane.
[[nodiscard]] const Silhouette& silhouette(ViewCode code);

} // namespace raywise
