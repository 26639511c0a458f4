// Degrees at the interfaces, radians inside.
#pragma once

#include <numbers>

namespace raywise {

[[nodiscard]] constexpr double to_radians(double degrees) {
    return degrees * (std::numbers::pi / 180);
}

} // namespace raywise
