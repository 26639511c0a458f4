// A ray made ready for the kernels: what is the same for all nodes and all triangles.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>

#include <hwy/base.h>

#include <array>
#include <cmath>
#include <cstddef>

namespace raywise::simd {

/// Where a ray meets the planes x = p of one axis: at p * scale + shift, of which the near one is
/// never too great and the far one never too small.
///
/// With e = 2^-24, o the origin, i = fl(1 / d) and S the largest of |o| and the tree's coordinates,
/// p * i + fl(-o * i) is off from (p - o) / d by at most e of itself for i, e of itself for the sum
/// and e (|p| + |o|) |i| for the products, one of which a fused multiply-add saves. `shift` moves
/// each plane outward by 8 e S |i|. Where the boxes are in another frame, the ray is turned into it
/// with errors of 4 e S for the origin and of 4 e m for the direction, m its largest component,
/// which moves a point inside the bounds by 8 e S more, and the planes are off by 2 e S: 24 e S in
/// all, so that 8 e S is 24 e S there. `far_scale` is 16 e greater than i, which covers the
/// relative errors of both ends and the rounding of t. So no box that holds a hit whose t, rounded,
/// is in [t_min, limit] has entry > exit.
///
/// Where |d| is at most e m, the ray stays within 16 e S of the plane x = o as long as it is inside
/// the bounds, where t <= 2 S / m, in either frame. i = 2^22 / m and a shift of 8 S / m then let
/// every such point through, zero directions included.
struct PlaneMap {
    float near_scale, near_shift;
    float far_scale, far_shift;
    std::size_t near_offset, far_offset; ///< bytes, of the planes in a WideNode
};

/// A ray against any node and block of one tree.
struct WideRay {
    std::array<PlaneMap, 3> axes;
    float t_min, t_max;

    // Of the sheared space of [Woop13], in which the ray is the z axis.
    std::size_t x, y, z; ///< bytes, of the axes in a vertex of a TriangleBlock; z is dominant
    float origin_x, origin_y, origin_z;
    float shear_x, shear_y;
    float inverse_z; ///< 1 / d_z

    /// An edge function of a triangle that the ray hits is off by at most doubled extent *
    /// edge_error_scale + edge_error_shift, see prepare.
    float edge_error_scale, edge_error_shift;
    /// t is off by at most edge error / |sum of edge functions| * (doubled extent *
    /// t_error_scale + t_error_slope) + t_error_shift.
    float t_error_scale, t_error_slope, t_error_shift;

    PrimId excluded;
};

/// No box that holds a hit whose t, rounded to float, is at most `t` has a greater entry.
[[nodiscard]] inline float reach(float t) {
    return t * (1 + 16 * 0x1p-24F) + 0x1p-120F;
}

namespace detail {

inline constexpr float unit_roundoff = 0x1p-24F;

HWY_INLINE PlaneMap map_planes(float o, float d, float inverse, float slack, std::size_t axis) {
    const float outward = slack * std::abs(inverse) + 0x1p-100F;
    const float far_inverse = inverse * (1 + 16 * unit_roundoff);
    constexpr std::size_t row = sizeof(WideNode::planes) / 6;
    const std::size_t lower = 2 * row * axis;
    const std::size_t turned = std::signbit(d) ? row : 0;
    return {
        inverse,
        -o * inverse - outward,
        far_inverse,
        -o * far_inverse + outward,
        lower + turned,
        lower + (row - turned)
    };
}

/// For a component that is too small beside the largest one, m; `size` is of all axes.
HWY_NOINLINE inline PlaneMap
map_flat_planes(float o, float d, float m, float size, std::size_t axis) {
    PlaneMap map = map_planes(o, d, std::copysign(0x1p22F / m, d), 0, axis);
    const float outward = 8 / m * size;
    map.near_shift -= outward;
    map.far_shift += outward;
    return map;
}

} // namespace detail

/// Fills `out`; false where float arithmetic could overflow or lose its bounds: coordinates beyond
/// 2^60, or a direction whose largest component is outside [2^-30, 2^30]. `ray` must be valid.
///
/// The error of an edge function is the one derived for ExactKernel::surely_misses; with the ratio
/// taken by a reciprocal it is at most e r (20 s + 50 e r), for s the largest sheared coordinate
/// and r = s + the largest depth. Here both come from bounds instead of the vertices: a triangle
/// that the ray hits has s <= its doubled extent, up to the rounding of s itself, 5 e z; z is
/// bounded by the tree's vertices.
///
/// With u' the computed edge functions, B their error, L the triangle's extent along z and z_i its
/// depths: the true depth z of the hit is within them, the computed one, z', leaves them by at most
/// 2 B L / |sum u'|. sum u' (z_i - z') = 0, so that |z - z'| <= 3 B L / |sum u| where |sum u'| > 8
/// B, and trivially at most L + 2 B L / |sum u'| elsewhere: 10 B L / |sum u'| in both cases, with L
/// half the doubled extent. The rest is rounding, of the depths, the weights and two quotients.
HWY_INLINE bool prepare(const Ray& ray, const WideBvh& tree, WideRay& out) {
    constexpr float e = detail::unit_roundoff;
    const std::array<float, 3> o{ray.origin.x, ray.origin.y, ray.origin.z};
    const std::array<float, 3> d{ray.direction.x, ray.direction.y, ray.direction.z};
    const std::array<float, 3> lo{
        tree.vertex_bounds.lo.x, tree.vertex_bounds.lo.y, tree.vertex_bounds.lo.z
    };
    const std::array<float, 3> hi{
        tree.vertex_bounds.hi.x, tree.vertex_bounds.hi.y, tree.vertex_bounds.hi.z
    };
    const std::array<float, 3> box_lo{tree.box.lo.x, tree.box.lo.y, tree.box.lo.z};
    const std::array<float, 3> box_hi{tree.box.hi.x, tree.box.hi.y, tree.box.hi.z};
    const std::array<float, 3> slopes{
        tree.frame.slopes.x, tree.frame.slopes.y, tree.frame.slopes.z
    };
    const auto larger = [](float a, float b) { return a > b ? a : b; };

    // Without branches: no predictor knows where a ray goes.
    const float across = larger(std::abs(d[0]), std::abs(d[1]));
    const auto z = std::abs(d[2]) > across
                       ? std::size_t{2}
                       : static_cast<std::size_t>(std::abs(d[1]) > std::abs(d[0]));
    const float m = larger(across, std::abs(d[2]));
    const auto along = static_cast<std::size_t>(tree.frame.axis);
    std::array<float, 3> frame_o; // NOLINT(*-member-init): written next
    std::array<float, 3> frame_d; // NOLINT(*-member-init): written next
    std::array<float, 3> sizes;   // NOLINT(*-member-init): written next
    for (std::size_t k = 0; k < 3; ++k) {
        frame_o[k] = o[k] - slopes[k] * o[along];
        frame_d[k] = d[k] - slopes[k] * d[along];
        sizes[k] = larger(
            larger(larger(std::abs(box_lo[k]), std::abs(box_hi[k])), std::abs(frame_o[k])),
            larger(larger(std::abs(lo[k]), std::abs(hi[k])), std::abs(o[k]))
        );
    }
    const float size = larger(larger(sizes[0], sizes[1]), sizes[2]);
    if (!(size <= 0x1p60F && m >= 0x1p-30F && m <= 0x1p30F)) [[unlikely]]
        return false;

    const bool is_world = tree.frame.is_world();
    const float slack_unit = is_world ? 8 * e : 24 * e;
    for (std::size_t k = 0; k < 3; ++k) {
        if (std::abs(frame_d[k]) <= e * m) [[unlikely]]
            out.axes[k] = detail::map_flat_planes(frame_o[k], frame_d[k], m, size, k);
        else
            out.axes[k] = detail::map_planes(
                frame_o[k], frame_d[k], 1 / frame_d[k], slack_unit * (is_world ? sizes[k] : size), k
            );
    }
    out.t_min = ray.t_min + 0.0F;
    out.t_max = ray.t_max;

    constexpr std::size_t row = sizeof(TriangleBlock::vertices) / 9;
    constexpr std::array<std::size_t, 5> turn{0, 1, 2, 0, 1};
    const std::size_t x = turn[z + 1];
    const std::size_t y = turn[z + 2];
    out.x = row * x;
    out.y = row * y;
    out.z = row * z;
    out.origin_x = o[x];
    out.origin_y = o[y];
    out.origin_z = o[z];
    out.inverse_z = 1 / d[z];
    out.shear_x = d[x] * out.inverse_z;
    out.shear_y = d[y] * out.inverse_z;

    constexpr float up = 1 + 0x1p-10F; // for the roundings of the bounds themselves
    const float depth = larger(std::abs(lo[z] - o[z]), std::abs(hi[z] - o[z])) * up;
    const float r = (depth + tree.largest_doubled_extent) * up;
    const float slowness = std::abs(out.inverse_z) * up;
    out.edge_error_scale = 24 * e * up * r;
    out.edge_error_shift = (e * r) * (e * up * (192 * depth + 64 * r)) + 0x1p-120F;
    out.t_error_scale = 5 * slowness;
    out.t_error_slope = 16 * e * depth * slowness;
    out.t_error_shift = (32 * e * depth + 0x1p-120F) * slowness;
    out.excluded = ray.excluded;
    return true;
}

} // namespace raywise::simd
