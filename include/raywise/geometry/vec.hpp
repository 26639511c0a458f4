// Vectors of three and two numbers, as plain data.
#pragma once

#include <algorithm>
#include <cmath>

namespace raywise {

template <class T>
struct BasicVec3 {
    T x{};
    T y{};
    T z{};

    [[nodiscard]] constexpr T operator[](int axis) const {
        return axis == 0 ? x : axis == 1 ? y : z;
    }

    [[nodiscard]] constexpr T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }

    friend constexpr bool operator==(const BasicVec3&, const BasicVec3&) = default;

    friend constexpr BasicVec3 operator+(BasicVec3 a, BasicVec3 b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }

    friend constexpr BasicVec3 operator-(BasicVec3 a, BasicVec3 b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }

    friend constexpr BasicVec3 operator-(BasicVec3 a) { return {-a.x, -a.y, -a.z}; }

    friend constexpr BasicVec3 operator*(BasicVec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }

    friend constexpr BasicVec3 operator*(T s, BasicVec3 a) { return a * s; }

    friend constexpr BasicVec3 operator/(BasicVec3 a, T s) { return {a.x / s, a.y / s, a.z / s}; }
};

using Vec3 = BasicVec3<float>;   ///< what is stored: vertices, boxes, rays
using Vec3d = BasicVec3<double>; ///< what is computed with: regions, projections, predicates

struct Vec2d {
    double x = 0;
    double y = 0;

    friend constexpr bool operator==(const Vec2d&, const Vec2d&) = default;

    friend constexpr Vec2d operator+(Vec2d a, Vec2d b) { return {a.x + b.x, a.y + b.y}; }

    friend constexpr Vec2d operator-(Vec2d a, Vec2d b) { return {a.x - b.x, a.y - b.y}; }

    friend constexpr Vec2d operator*(Vec2d a, double s) { return {a.x * s, a.y * s}; }
};

template <class T>
[[nodiscard]] constexpr T dot(BasicVec3<T> a, BasicVec3<T> b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

template <class T>
[[nodiscard]] constexpr BasicVec3<T> cross(BasicVec3<T> a, BasicVec3<T> b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// z of the three-dimensional cross product: twice the signed area of the triangle (0, a, b).
[[nodiscard]] constexpr double cross(Vec2d a, Vec2d b) {
    return a.x * b.y - a.y * b.x;
}

template <class T>
[[nodiscard]] T length(BasicVec3<T> a) {
    return std::sqrt(dot(a, a));
}

/// a / |a|; NaN for the zero vector.
template <class T>
[[nodiscard]] BasicVec3<T> normalized(BasicVec3<T> a) {
    return a / length(a);
}

template <class T>
[[nodiscard]] constexpr BasicVec3<T> min(BasicVec3<T> a, BasicVec3<T> b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}

template <class T>
[[nodiscard]] constexpr BasicVec3<T> max(BasicVec3<T> a, BasicVec3<T> b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

template <class T>
[[nodiscard]] BasicVec3<T> abs(BasicVec3<T> a) {
    return {std::abs(a.x), std::abs(a.y), std::abs(a.z)};
}

template <class T>
[[nodiscard]] bool is_finite(BasicVec3<T> a) {
    return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z);
}

/// The axis of the largest component by magnitude; the first of equals.
template <class T>
[[nodiscard]] int dominant_axis(BasicVec3<T> a) {
    const BasicVec3<T> m = abs(a);
    if (m.x >= m.y && m.x >= m.z) return 0;
    return m.y >= m.z ? 1 : 2;
}

[[nodiscard]] constexpr Vec3d to_double(Vec3 a) {
    return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

/// Each component rounded to the nearest float.
[[nodiscard]] constexpr Vec3 to_float(Vec3d a) {
    return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}

} // namespace raywise
