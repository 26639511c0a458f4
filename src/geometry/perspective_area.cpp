#include <raywise/geometry/perspective_area.hpp>

#include "geometry/box_edges.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/convex_polygon.hpp>
#include <raywise/geometry/fixed_polygon.hpp>
#include <raywise/geometry/silhouette.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace raywise {

namespace {

bool is_positive(double value) {
    return value > 0 && std::isfinite(value);
}

double clamped_to_one(double share) {
    return std::clamp(share, 0.0, 1.0);
}

/// From the view space in which the pyramid is |x| <= z, |y| <= z.
Vec2d to_window(Vec3d view) {
    return {view.x / view.z, view.y / view.z};
}

/// How far the eye is outside the box's slab along an axis; 0 within it.
double distance_to_slab(double eye, double lo, double hi) {
    return std::max({lo - eye, eye - hi, 0.0});
}

} // namespace

PerspectiveView::PerspectiveView(const PerspectiveWindow& window)
    : window_(window)
    , right_(window.frame.right / window.tan_x)
    , up_(window.frame.up / window.tan_y)
    , side_planes_{
          window.frame.forward + right_,
          window.frame.forward - right_,
          window.frame.forward + up_,
          window.frame.forward - up_
      } {
    if (!is_positive(window.tan_x) || !is_positive(window.tan_y))
        throw Error("the field of view of a window must be between 0 and 180 degrees");
    if (!(window.near >= 0) || !std::isfinite(window.near))
        throw Error("the near depth of a window must be finite and not negative");
    if (!is_finite(window.eye)) throw Error("the eye of a window must be finite");
}

PerspectiveView::Relation PerspectiveView::relation(const Aabb& box) const {
    if (box.is_empty()) return Relation::outside;
    if (window_.near == 0 && contains(box, window_.eye)) return Relation::around;
    const Vec3d center = (to_double(box.lo) + to_double(box.hi)) * 0.5 - window_.eye;
    const Vec3d half = (to_double(box.hi) - to_double(box.lo)) * 0.5;
    const double depth = dot(window_.frame.forward, center);
    const double depth_radius = dot(abs(window_.frame.forward), half);
    if (depth + depth_radius < window_.near) return Relation::outside;
    bool inside = depth - depth_radius >= window_.near && depth > depth_radius;
    for (const Vec3d& plane : side_planes_) {
        const double height = dot(plane, center);
        const double radius = dot(abs(plane), half);
        if (height + radius < 0) return Relation::outside;
        inside = inside && height >= radius;
    }
    return inside ? Relation::inside : Relation::across;
}

// A face at distance h from the eye covers, per unit of its own area, h / z^3 of the image plane at
// distance 1. The depth z is affine on the face, so the integral over the rectangle is elementary:
// h (area) z_middle / (z_00 z_01 z_10 z_11), with the depths of the middle and of the corners. At
// most three faces are seen, and their shadows do not overlap.
double PerspectiveView::inside_share(const Aabb& box) const {
    const Vec3d lo = to_double(box.lo);
    const Vec3d hi = to_double(box.hi);
    const Vec3d size = hi - lo;
    const Vec3d& forward = window_.frame.forward;
    const double middle = dot(forward, (lo + hi) * 0.5 - window_.eye);
    double image_area = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const double distance = distance_to_slab(window_.eye[axis], lo[axis], hi[axis]);
        if (distance == 0) continue;
        const int i = (axis + 1) % 3;
        const int j = (axis + 2) % 3;
        const double side = window_.eye[axis] < lo[axis] ? -0.5 : 0.5;
        const double z = middle + side * forward[axis] * size[axis];
        const double a = 0.5 * forward[i] * size[i];
        const double b = 0.5 * forward[j] * size[j];
        const double corners = (z - a - b) * (z - a + b) * (z + a - b) * (z + a + b);
        image_area += distance * size[i] * size[j] * (z / corners);
    }
    return clamped_to_one(image_area / (4 * window_.tan_x * window_.tan_y));
}

double PerspectiveView::sum_over_shadow(
    const Aabb& box,
    FunctionRef<double(const ConvexPolygon&)> weigh
) const {
    const Relation lies = relation(box);
    if (lies == Relation::outside) return 0;
    if (lies == Relation::around) return weigh(to_polygon(Rectangle{}));
    ViewVertices vertices;
    double least = HUGE_VAL;
    double most = -HUGE_VAL;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        vertices[i] = to_view(to_double(box.vertex(static_cast<int>(i))));
        least = std::min(least, vertices[i].z);
        most = std::max(most, vertices[i].z);
    }
    if (lies == Relation::inside) return weigh(outline(box, vertices));
    // Dividing by a depth that is small next to the box would send vertices far away, and the
    // window's clip would lose their digits.
    constexpr double shallow = 1e-6;
    if (least >= window_.near && least > shallow * most)
        return weigh(intersect(outline(box, vertices), Rectangle{}));
    return sum_over_faces(box, vertices, weigh);
}

ConvexPolygon PerspectiveView::outline(const Aabb& box, const ViewVertices& vertices) const {
    const Silhouette& cycle = silhouette(view_from(box, window_.eye));
    ConvexPolygon polygon;
    for (std::size_t i = 0; i < cycle.size; ++i)
        polygon.push_back(to_window(vertices[cycle.vertices[i]]));
    return polygon;
}

// The faces that the eye sees are clipped in space by the planes of the window, before anything is
// divided by a depth. Where the near plane cuts the box, the rays that start inside it meet it too.
double PerspectiveView::sum_over_faces(
    const Aabb& box,
    const ViewVertices& vertices,
    FunctionRef<double(const ConvexPolygon&)> weigh
) const {
    double sum = 0;
    for (int axis = 0; axis < 3; ++axis) {
        const auto k = static_cast<std::size_t>(axis);
        const double eye = window_.eye[axis];
        const double lo = to_double(box.lo)[axis];
        const double hi = to_double(box.hi)[axis];
        if (distance_to_slab(eye, lo, hi) == 0) continue;
        FixedPolygon<Vec3d> face;
        for (const std::size_t corner : box_faces[k][eye < lo ? 0 : 1])
            face.push_back(vertices[corner]);
        face = clipped(face, [&](Vec3d p) { return p.z - window_.near; });
        face = clipped(face, [](Vec3d p) { return p.z + p.x; });
        face = clipped(face, [](Vec3d p) { return p.z - p.x; });
        face = clipped(face, [](Vec3d p) { return p.z + p.y; });
        face = clipped(face, [](Vec3d p) { return p.z - p.y; });
        ConvexPolygon piece;
        for (const Vec3d& corner : face)
            if (corner.z > 0) piece.push_back(to_window(corner));
        if (piece.size() >= 3) sum += weigh(piece);
    }
    if (window_.near > 0) {
        const ConvexPolygon section = near_section(box);
        if (section.size() >= 3) sum += weigh(section);
    }
    return sum;
}

/// The part of the window from which rays start inside the box.
ConvexPolygon PerspectiveView::near_section(const Aabb& box) const {
    const Vec3d middle = window_.eye + window_.frame.forward * window_.near;
    const Vec3d along_x = window_.frame.right * (window_.near * window_.tan_x);
    const Vec3d along_y = window_.frame.up * (window_.near * window_.tan_y);
    ConvexPolygon section = to_polygon(Rectangle{});
    for (int axis = 0; axis < 3; ++axis) {
        const auto position = [&](Vec2d p) {
            return middle[axis] + along_x[axis] * p.x + along_y[axis] * p.y;
        };
        const double lo = to_double(box.lo)[axis];
        const double hi = to_double(box.hi)[axis];
        section = clipped(section, [&](Vec2d p) { return position(p) - lo; });
        section = clipped(section, [&](Vec2d p) { return hi - position(p); });
    }
    return section;
}

Vec3d PerspectiveView::to_view(Vec3d point) const {
    const Vec3d from_eye = point - window_.eye;
    return {dot(right_, from_eye), dot(up_, from_eye), dot(window_.frame.forward, from_eye)};
}

PerspectiveProjection::PerspectiveProjection(const PerspectiveWindow& window) : view_(window) {}

double PerspectiveProjection::operator()(const Aabb& box) const {
    if (view_.relation(box) == PerspectiveView::Relation::inside) return view_.inside_share(box);
    const auto window_share = [](const ConvexPolygon& piece) { return area(piece) / 4; };
    return clamped_to_one(view_.sum_over_shadow(box, window_share));
}

} // namespace raywise
