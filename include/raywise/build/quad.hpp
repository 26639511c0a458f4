// Four floats in one register: the builders' unit of work. A vector type of the language extension
// that g++ and clang share; neither finds the packed minimum in a loop over four floats.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstdint>
#include <limits>

namespace raywise {

using Quad [[gnu::vector_size(16)]] = float;
using IntQuad [[gnu::vector_size(16)]] = std::int32_t;

/// Lane by lane; of equals the first.
[[nodiscard]] inline Quad min(Quad a, Quad b) {
    return b < a ? b : a;
}

[[nodiscard]] inline Quad max(Quad a, Quad b) {
    return b > a ? b : a;
}

[[nodiscard]] inline Quad make_quad(float value) {
    return Quad{value, value, value, value};
}

[[nodiscard]] inline Vec3 to_vec(Quad a) {
    return {a[0], a[1], a[2]};
}

/// A box in two registers; the fourth lanes mean nothing. Empty by default.
struct QuadBox {
    Quad lo = make_quad(std::numeric_limits<float>::infinity());
    Quad hi = make_quad(-std::numeric_limits<float>::infinity());

    void unite(Quad other_lo, Quad other_hi) {
        lo = min(lo, other_lo);
        hi = max(hi, other_hi);
    }

    void unite(const QuadBox& other) { unite(other.lo, other.hi); }

    void unite(Quad point) { unite(point, point); }
};

[[nodiscard]] inline Aabb to_aabb(const QuadBox& box) {
    return {to_vec(box.lo), to_vec(box.hi)};
}

} // namespace raywise
