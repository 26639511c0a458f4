// A ray made ready for the kernels: what is the same for all nodes and all triangles.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>

#include <array>
#include <cstddef>
#include <optional>

namespace raywise::simd {

/// Where a ray meets the planes x = p of one axis: at p * scale + shift, of which the near one is
/// never too great and the far one never too small.
///
/// With e = 2^-24, o the origin, i = fl(1 / d) and S the largest of |o| and the tree's coordinates,
/// p * i + fl(-o * i) is off from (p - o) / d by at most e of itself for i, e of itself for the sum
/// and e (|p| + |o|) |i| for the products, one of which a fused multiply-add saves. `shift` moves
/// each plane outward by 8 e S |i|; `far_scale` is 16 e greater than i, which covers the relative
/// errors of both ends and the rounding of t. So no box that holds a hit whose t, rounded, is in
/// [t_min, limit] has entry > exit.
///
/// Where |d| is at most 2^-24 of the largest component m, the ray stays within 2^-22 S of the
/// plane x = o as long as it is inside the bounds, where t <= 2 S / m. i = 2^22 / m and a shift of
/// 4 S / m then let every such point through, zero directions included.
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

/// Nothing where float arithmetic could overflow or lose its bounds: coordinates beyond 2^60, or a
/// direction whose largest component is outside [2^-30, 2^30]. `ray` must be valid.
[[nodiscard]] std::optional<WideRay> prepare(const Ray& ray, const WideBvh& tree);

/// No box that holds a hit whose t, rounded to float, is at most `t` has a greater entry.
[[nodiscard]] inline float reach(float t) {
    return t * (1 + 16 * 0x1p-24F) + 0x1p-120F;
}

} // namespace raywise::simd
