#include <raywise/geometry/frame.hpp>

#include <raywise/core/error.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>

namespace raywise {

Frame frame_along(Vec3d direction, double roll_rad) {
    const double largest =
        std::max({std::abs(direction.x), std::abs(direction.y), std::abs(direction.z)});
    if (!is_finite(direction) || !(largest > 0))
        throw Error("a direction must be finite and not zero");
    if (!std::isfinite(roll_rad)) throw Error("a roll must be finite");
    // Scaled first, so that the squares of a tiny or huge direction neither vanish nor overflow.
    const Vec3d forward = normalized(direction / largest);
    constexpr double vertical_rad = 1e-4;
    const Vec3d across_up = cross(Vec3d{0, 1, 0}, forward);
    const bool vertical = length(across_up) < std::sin(vertical_rad);
    const Vec3d across_x = Vec3d{1, 0, 0} - forward * forward.x;
    const Vec3d right = normalized(vertical ? across_x : across_up);
    const Vec3d up = cross(forward, right);
    const double c = std::cos(roll_rad);
    const double s = std::sin(roll_rad);
    return {right * c + up * s, up * c - right * s, forward};
}

} // namespace raywise
