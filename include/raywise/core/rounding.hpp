// Bounds of floating-point rounding errors. After [Higham02].
#pragma once

namespace raywise {

/// Unit roundoff of float and of double: half the gap between 1 and the next number.
inline constexpr double float_epsilon = 0x1p-24;
inline constexpr double double_epsilon = 0x1p-53;

/// Relative error bound of `n` rounded operations in a row: n e / (1 - n e). [Higham02]
[[nodiscard]] constexpr double gamma_bound(int n, double epsilon) {
    return n * epsilon / (1.0 - n * epsilon);
}

} // namespace raywise
