// Vectors of rational numbers, for oracles without rounding.
#pragma once

#include <raywise/geometry/vec.hpp>

#include <gmpxx.h>

namespace raywise::oracle {

struct Rational3 {
    mpq_class x, y, z;
};

inline Rational3 exact(Vec3 a) {
    return {
        mpq_class(static_cast<double>(a.x)),
        mpq_class(static_cast<double>(a.y)),
        mpq_class(static_cast<double>(a.z))
    };
}

inline Rational3 minus(const Rational3& a, const Rational3& b) {
    return {a.x - b.x, a.y - b.y, a.z - b.z};
}

inline mpq_class dot(const Rational3& a, const Rational3& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

inline Rational3 cross(const Rational3& a, const Rational3& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

} // namespace raywise::oracle
