// A ray made ready for the kernels: what is the same for all nodes and all triangles.
#pragma once

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/ids.hpp>

#include <array>
#include <cstddef>
#include <cstdint>

namespace raywise::simd {

/// Where a ray meets the planes x = p of each axis: at p * scale + shift, of which the near one is
/// never too great and the far one never too small.
///
/// With e = 2^-24, o the origin, i = fl(1 / d) and S the largest of |o| and the tree's coordinates,
/// p * i + fl(-o * i) is off from (p - o) / d by at most e of itself for i, e of itself for the sum
/// and e (|p| + |o|) |i| for the products, some of which a fused multiply-add saves. `shift` moves
/// each plane outward by 8 e S |i|. Where the boxes are in another frame, the ray is turned into it
/// with errors of 4 e S for the origin and of 4 e m for the direction, m its largest component,
/// which moves a point inside the bounds by 8 e S more, and the planes are off by 2 e S: 24 e S in
/// all, so that 8 e S is 24 e S there. `far_scale` is 16 e greater than i, which covers the
/// relative errors of both ends and the rounding of t. Each of these is more than is needed, and at
/// least 2^-100 is added: so a box that holds a hit whose t, rounded, is in [t_min, limit] has
/// entry < exit and exit > 0.
///
/// Where |d| is at most e m, the ray stays within 16 e S of the plane x = o as long as it is inside
/// the bounds, where t <= 2 S / m, in either frame. d = 4 e m in its place, i = 2^22 / m, and a
/// shift of 32 e S |i| = 8 S / m then let every such point through, zero directions included.
struct PlaneMaps {
    using PerAxis = std::array<float, 4>; ///< x, y, z and nothing

    alignas(16) PerAxis near_scale;
    alignas(16) PerAxis near_shift;
    alignas(16) PerAxis far_scale;
    alignas(16) PerAxis far_shift;
    alignas(16) std::array<std::uint32_t, 4> near_offset; ///< bytes, of the planes in a WideNode
    alignas(16) std::array<std::uint32_t, 4> far_offset;
};

/// A ray against any node and block of one tree.
struct WideRay {
    PlaneMaps planes;
    float t_min, t_max;
    float largest; ///< magnitude of a component of the direction

    // Of the sheared space of [Woop13], in which the ray is the z axis.
    std::array<std::uint32_t, 3>
        rows; ///< bytes, of x, y, z in a vertex of a TriangleBlock; z is dominant
    alignas(16) std::array<float, 4> origin; ///< x, y, z and nothing
    alignas(16) std::array<float, 4> shear;  ///< d_x / d_z, d_y / d_z, 1 / d_z and nothing

    PrimId excluded;
};

/// No box that holds a hit whose t, rounded to float, is at most `t` has a greater entry.
[[nodiscard]] inline float reach(float t) {
    return t * (1 + 16 * 0x1p-24F) + 0x1p-120F;
}

} // namespace raywise::simd
