// Boxes, frusta and triangles as the separating axis test sees them: shadows on an axis, face
// normals, edge directions. Prepare a body once, test it often.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/frustum.hpp>
#include <raywise/geometry/obb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>
#include <concepts>
#include <span>

namespace raywise {

/// The closed interval of dot(axis, p) over a body.
struct Shadow {
    double lo = 0;
    double hi = 0;
};

/// A convex polytope. `reach` bounds the magnitude of each coordinate of its points: what rounding
/// errors scale with.
template <class B>
concept ConvexBody = requires(const B& body, Vec3d axis) {
    { body.shadow(axis) } -> std::same_as<Shadow>;
    { body.normals() } -> std::convertible_to<std::span<const Vec3d>>;
    { body.edges() } -> std::convertible_to<std::span<const Vec3d>>;
    { body.reach() } -> std::convertible_to<Vec3d>;
};

/// A box, axis-aligned or oriented. Flat ones keep all three normals.
class BoxBody {
public:
    /// `box` is not empty.
    explicit BoxBody(const Aabb& box);
    explicit BoxBody(const Obb& box);

    [[nodiscard]] Shadow shadow(Vec3d axis) const;

    [[nodiscard]] std::span<const Vec3d> normals() const { return axes_; }

    [[nodiscard]] std::span<const Vec3d> edges() const { return axes_; }

    [[nodiscard]] Vec3d reach() const { return reach_; }

private:
    Vec3d center_;
    std::array<Vec3d, 3> axes_; ///< unit
    Vec3d half_;
    Vec3d reach_;
};

/// A frustum: five normals (near and far are parallel), six edge directions. near = 0 keeps them.
class FrustumBody {
public:
    explicit FrustumBody(const Frustum& frustum);

    [[nodiscard]] Shadow shadow(Vec3d axis) const;

    [[nodiscard]] std::span<const Vec3d> normals() const { return normals_; }

    [[nodiscard]] std::span<const Vec3d> edges() const { return edges_; }

    [[nodiscard]] Vec3d reach() const { return reach_; }

private:
    Vec3d eye_;
    Vec3d forward_;
    Vec3d right_; ///< times tan_x
    Vec3d up_;    ///< times tan_y
    double near_;
    double far_;
    std::array<Vec3d, 5> normals_;
    std::array<Vec3d, 6> edges_;
    Vec3d reach_;
};

/// A triangle; one of no area has no normal and is tested as the segment or point it is.
class TriangleBody {
public:
    /// Finite vertices.
    explicit TriangleBody(const Triangle& triangle);

    [[nodiscard]] Shadow shadow(Vec3d axis) const;

    [[nodiscard]] std::span<const Vec3d> normals() const { return {&normal_, normal_count_}; }

    [[nodiscard]] std::span<const Vec3d> edges() const { return edges_; }

    [[nodiscard]] Vec3d reach() const { return reach_; }

private:
    std::array<Vec3d, 3> vertices_;
    std::array<Vec3d, 3> edges_;
    Vec3d normal_;
    std::size_t normal_count_ = 0;
    Vec3d reach_;
};

} // namespace raywise
