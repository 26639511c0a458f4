// Shadows of boxes seen from an eye, cut by a window. After [Schmalstieg99]; the closed form for
// boxes inside the window, and the clipping without an image plane, are ours.
#pragma once

#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/vec.hpp>

#include <array>

namespace raywise {

/// A frustum's opening, as rays leave it.
struct PerspectiveWindow {
    Vec3d eye = {};
    Frame frame = {};
    double tan_x = 1; ///< tangent of half the horizontal field of view, > 0, finite
    double tan_y = 1; ///< of half the vertical one
    double near = 0;  ///< depth at which the rays start, >= 0, finite; 0: at the eye
};

/// What a window's rays see of boxes. The shadow of a box is reported in window coordinates
/// (x / (z tan_x), y / (z tan_y)), cut to [-1, 1]^2, as convex pieces that do not overlap: one
/// piece when the box is in front of the eye, up to four when it reaches behind. This is what the
/// pinhole, isotropic and yaw-pitch measures share; they differ in how they weigh a piece.
class PerspectiveView {
public:
    /// How a box lies to the window's pyramid.
    enum class Relation : unsigned char {
        outside, ///< no ray meets it, empty boxes included
        inside,  ///< in front of the eye and wholly in the pyramid
        across,  ///< anything else
        around,  ///< the rays start at the eye and the eye is in the box: every ray meets it
    };

    /// Throws Error when a value is out of its range.
    explicit PerspectiveView(const PerspectiveWindow& window);

    [[nodiscard]] const PerspectiveWindow& window() const { return window_; }

    [[nodiscard]] Relation relation(const Aabb& box) const;

    /// The sum of `weigh(piece)` over the pieces of the shadow: none of a box outside, the whole
    /// window for a box around the eye.
    [[nodiscard]] double
    sum_over_shadow(const Aabb& box, FunctionRef<double(const ConvexPolygon&)> weigh) const;

    /// The share of the window that the shadow covers; the closed form. Relation inside only.
    [[nodiscard]] double inside_share(const Aabb& box) const;

    /// The point relative to the eye, along right, up and forward, scaled so that the pyramid is
    /// |x| <= z, |y| <= z.
    [[nodiscard]] Vec3d to_view(Vec3d point) const;

private:
    using ViewVertices = std::array<Vec3d, 8>;

    [[nodiscard]] ConvexPolygon outline(const Aabb& box, const ViewVertices& vertices) const;
    [[nodiscard]] double sum_over_faces(
        const Aabb& box,
        const ViewVertices& vertices,
        FunctionRef<double(const ConvexPolygon&)> weigh
    ) const;
    [[nodiscard]] ConvexPolygon near_section(const Aabb& box) const;

    PerspectiveWindow window_;
    Vec3d right_;                      ///< over tan_x
    Vec3d up_;                         ///< over tan_y
    std::array<Vec3d, 4> side_planes_; ///< inward normals of left, right, bottom, top
};

/// The share of a pinhole's rays that meet a box (uniform on the image plane): area of the shadow
/// of the part beyond `near`, cut by the window, over the window's area; in [0, 1]. 1 when the rays
/// start at the eye and the eye is in the box. Monotone up to 1e-9. A box wholly inside the window
/// costs one closed form. No allocation.
class PerspectiveProjection {
public:
    /// Throws Error when a value is out of its range.
    explicit PerspectiveProjection(const PerspectiveWindow& window);

    [[nodiscard]] double operator()(const Aabb& box) const;

    [[nodiscard]] const PerspectiveWindow& window() const { return view_.window(); }

private:
    PerspectiveView view_;
};

} // namespace raywise
