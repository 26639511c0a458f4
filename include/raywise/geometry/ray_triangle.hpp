// Ray against triangle, decided in exact arithmetic; and the fast kernel that is not watertight.
// After [Woop13], [Shewchuk97], [Moeller97]. Ours: the filter's bound and the correctly rounded t.
#pragma once

#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle.hpp>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>

namespace raywise {

enum class FaceMode {
    both,
    front, ///< only triangles whose vertices the ray sees counter-clockwise
};

/// A ray kernel: made once per valid ray, then asked for the hit with one triangle after another.
/// The answer is a hit with t in [ray.t_min, t_max] or nothing.
template <class K>
concept TriangleKernel =
    std::is_constructible_v<K, const Ray&> &&
    requires(const K& kernel, const Triangle& triangle, PrimId id, float t_max) {
        { kernel(triangle, id, t_max) } -> std::same_as<std::optional<Hit>>;
    };

/// What a hit is. The triangle is hit iff the real line origin + t * direction meets the closed
/// triangle at one point (edges and vertices included, zero area and rays in the plane excluded),
/// and the exact t, rounded to the nearest float, is finite and in [t_min, t_max]. Decided by a
/// float filter, then a double filter, then expansions: exact for all finite floats, watertight,
/// the same on every machine. u and v are within 2^-22 of the exact weights. A zero t is +0. A
/// vertex that is not finite is never hit. No allocation.
class ExactKernel {
public:
    /// `ray` must be valid and outlive the kernel.
    explicit ExactKernel(const Ray& ray);

    [[nodiscard]] std::optional<Hit>
    operator()(const Triangle& triangle, PrimId id, float t_max) const {
        if (surely_misses(triangle) || id == ray_->excluded) return std::nullopt;
        return decide(*ray_, triangle, id, t_max);
    }

    /// The double and exact stages alone; the filter above only answers "no" sooner.
    [[nodiscard]] static std::optional<Hit>
    decide(const Ray& ray, const Triangle& triangle, PrimId id, float t_max);

private:
    [[nodiscard]] bool surely_misses(const Triangle& triangle) const;

    [[nodiscard]] static float component(const Vec3& point, std::size_t offset) {
        float x = 0;
        std::memcpy(&x, reinterpret_cast<const std::byte*>(&point) + offset, sizeof x);
        return x;
    }

    const Ray* ray_;
    std::size_t x_, y_, z_; ///< byte offsets of the axes, turned so that z is the dominant one
    float origin_x_, origin_y_, origin_z_;
    float shear_x_, shear_y_; ///< direction x / z and y / z
};

/// Not watertight: float arithmetic without guards, a few units in the last place near edges may be
/// lost or doubled, and t carries some rounding errors. Ties and order as for ExactKernel.
/// [Moeller97]
class FastKernel {
public:
    /// `ray` must be valid and outlive the kernel.
    explicit FastKernel(const Ray& ray) : ray_(&ray) {}

    [[nodiscard]] std::optional<Hit>
    operator()(const Triangle& triangle, PrimId id, float t_max) const;

private:
    const Ray* ray_;
};

/// Keeps the hits of another kernel that see the front.
template <TriangleKernel Kernel>
class FrontFaces {
public:
    explicit FrontFaces(const Ray& ray) : kernel_(ray) {}

    [[nodiscard]] std::optional<Hit>
    operator()(const Triangle& triangle, PrimId id, float t_max) const {
        const std::optional<Hit> hit = kernel_(triangle, id, t_max);
        return hit && hit->front ? hit : std::nullopt;
    }

private:
    Kernel kernel_;
};

/// The exact hit of one ray with one triangle, as ExactKernel defines it. Nothing for a ray that is
/// not `is_valid`.
[[nodiscard]] std::optional<Hit> intersect(
    const Ray& ray,
    const Triangle& triangle,
    PrimId id = PrimId{0},
    FaceMode faces = FaceMode::both
);

} // namespace raywise

#include <raywise/geometry/ray_triangle.inl.hpp> // IWYU pragma: export
