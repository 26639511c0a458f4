// Ray against box: the closed reference form, and the conservative slab test of the traversals.
// After [Kay86], [Williams05], [Ize13]. Ours: the bounds that let no exact hit be culled.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <optional>

namespace raywise {

/// A closed piece of a ray, in units of its direction.
struct Interval {
    float entry;
    float exit;

    friend constexpr bool operator==(const Interval&, const Interval&) = default;
};

/// The part of the ray inside the closed box; entry is t_min when the ray starts inside. An axis
/// with direction 0 (either sign) only asks whether the origin is between its faces. Touching
/// counts. Computed in double and rounded to nearest: a touch is never lost when the differences
/// face - origin are exact in double (exponents within 29 bits). Nothing for an empty box, a NaN,
/// or a ray that is not `is_valid`.
[[nodiscard]] std::optional<Interval> intersect(const Ray& ray, const Aabb& box);

/// The slab test of a traversal, prepared once per ray. Conservative: a box that holds an exact hit
/// whose t, rounded to float, lies in [t_min, limit] is never refused, for all finite floats; a box
/// that the ray misses by a few units in the last place may be accepted.
///
/// Why: each plane distance (x - o) * (1 / d) carries three roundings, so an entry is at most
/// (1 + gamma(3)) times too large and an exit as much too small; t itself was rounded once, and so
/// are the two steps of `reach`. Together that is below 10 units of roundoff; 12 are granted. The
/// absolute term covers products that underflow. Float needs |1 / d_k| to be a normal number: rays
/// that are `needs_wide_slab` take Real = double.
template <class Real>
class BasicSlab {
public:
    struct Touch {
        Real entry; ///< where the ray enters the box, at least t_min; meaningful when hit
        bool hit;
    };

    /// `ray` must be valid.
    explicit BasicSlab(const Ray& ray)
        : origin_{Real(ray.origin.x), Real(ray.origin.y), Real(ray.origin.z)}
        , inverse_{Real(1) / Real(ray.direction.x), Real(1) / Real(ray.direction.y), Real(1) / Real(ray.direction.z)}
        , t_min_(Real(ray.t_min)) {
        near_[0] = near_face(ray.direction.x, offsetof(Aabb, lo), offsetof(Aabb, hi));
        near_[1] =
            near_face(ray.direction.y, offsetof(Aabb, lo), offsetof(Aabb, hi)) + sizeof(float);
        near_[2] =
            near_face(ray.direction.z, offsetof(Aabb, lo), offsetof(Aabb, hi)) + 2 * sizeof(float);
        far_[0] = near_face(-ray.direction.x, offsetof(Aabb, lo), offsetof(Aabb, hi));
        far_[1] =
            near_face(-ray.direction.y, offsetof(Aabb, lo), offsetof(Aabb, hi)) + sizeof(float);
        far_[2] =
            near_face(-ray.direction.z, offsetof(Aabb, lo), offsetof(Aabb, hi)) + 2 * sizeof(float);
    }

    /// No box that holds a hit whose t, rounded to float, is at most `t` has a greater entry.
    [[nodiscard]] static Real reach(Real t) { return t * enlarge + tiny; }

    /// Tests the box against [t_min, limit].
    [[nodiscard]] Touch operator()(const Aabb& box, Real limit) const {
        // A ray in a face yields 0 * inf = NaN; the comparisons keep the other operand. [Ize13]
        const Real entry = larger(
            distance(box, near_[0], 0),
            larger(distance(box, near_[1], 1), larger(distance(box, near_[2], 2), t_min_))
        );
        const Real exit = smaller(
            distance(box, far_[0], 0),
            smaller(distance(box, far_[1], 1), smaller(distance(box, far_[2], 2), limit))
        );
        return {entry, entry <= reach(exit)};
    }

private:
    static constexpr Real enlarge = Real(1 + 12 * 0x1p-24);
    static constexpr Real tiny = Real(0x1p-120);

    static std::size_t near_face(float direction, std::size_t lo, std::size_t hi) {
        return std::signbit(direction) ? hi : lo;
    }

    /// The second operand when the first is NaN.
    static Real larger(Real a, Real b) { return a > b ? a : b; }

    static Real smaller(Real a, Real b) { return a < b ? a : b; }

    [[nodiscard]] Real distance(const Aabb& box, std::size_t face, int axis) const {
        float x = 0;
        std::memcpy(&x, reinterpret_cast<const std::byte*>(&box) + face, sizeof x);
        return (Real(x) - origin_[axis]) * inverse_[axis];
    }

    BasicVec3<Real> origin_;
    BasicVec3<Real> inverse_;
    Real t_min_;
    std::array<std::size_t, 3> near_{
    }; ///< byte offsets into Aabb of the faces that the ray enters by
    std::array<std::size_t, 3> far_{};
};

using Slab = BasicSlab<float>;
using WideSlab = BasicSlab<double>;

/// Whether some component of the direction is so small or so large that its inverse is not a normal
/// float.
[[nodiscard]] inline bool needs_wide_slab(const Ray& ray) {
    const auto is_extreme = [](float d) {
        const float size = std::abs(d);
        return size != 0 && (size < 0x1p-126F || size > 0x1p126F);
    };
    return is_extreme(ray.direction.x) || is_extreme(ray.direction.y) ||
           is_extreme(ray.direction.z);
}

} // namespace raywise
