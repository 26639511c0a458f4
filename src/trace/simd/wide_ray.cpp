#include "trace/simd/wide_ray.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>

namespace raywise::simd {
namespace {

constexpr float e = 0x1p-24F;

PlaneMap map_planes(float o, float d, float largest_coordinate, float m, int axis) {
    const bool is_flat = std::abs(d) <= e * m;
    const float inverse = is_flat ? std::copysign(0x1p22F / m, d) : 1 / d;
    const float outward =
        (is_flat ? 4 / m * largest_coordinate : 8 * e * largest_coordinate * std::abs(inverse)) +
        0x1p-100F;
    const float far_inverse = inverse * (1 + 16 * e);
    constexpr std::size_t row = sizeof(WideNode::planes) / 6;
    const std::size_t lower = 2 * row * static_cast<std::size_t>(axis);
    const bool is_negative = std::signbit(d);
    return {
        inverse,
        -o * inverse - outward,
        far_inverse,
        -o * far_inverse + outward,
        is_negative ? lower + row : lower,
        is_negative ? lower : lower + row
    };
}

float largest_size(float a, float b) {
    return std::max(std::abs(a), std::abs(b));
}

} // namespace

// The error of an edge function is the one derived for ExactKernel::surely_misses, e r (20 s + 32 e
// r), for s the largest sheared coordinate and r = s + the largest depth. Here both come from
// bounds instead of the vertices: a triangle that the ray hits has s <= its doubled extent, up to
// the rounding of s itself, 4 e z; z is bounded by the tree's vertices.
//
// With û the computed edge functions, B their error, L the triangle's extent along z and z_i its
// depths: the true depth z of the hit is within them, the computed one, ẑ, leaves them by at most 2
// B L / |sum û|. sum u (z - ẑ) = 0 for û, so that |z - ẑ| <= 3 B L / |sum u| where |sum û| > 8 B,
// and trivially at most L + 2 B L / |sum û| elsewhere: 10 B L / |sum û| in both cases, with L half
// the doubled extent. The rest is rounding, of the depths, the weights and the two quotients.
std::optional<WideRay> prepare(const Ray& ray, const WideBvh& tree) {
    const int z = dominant_axis(ray.direction);
    const int x = z == 2 ? 0 : z + 1;
    const int y = x == 2 ? 0 : x + 1;
    const Vec3& o = ray.origin;
    const Vec3& d = ray.direction;
    const Aabb& box = tree.bounds;
    const float m = std::abs(d[z]);
    const Vec3 sizes{
        std::max(largest_size(box.lo.x, box.hi.x), std::abs(o.x)),
        std::max(largest_size(box.lo.y, box.hi.y), std::abs(o.y)),
        std::max(largest_size(box.lo.z, box.hi.z), std::abs(o.z))
    };
    const float largest = std::max(std::max(sizes.x, sizes.y), sizes.z);
    if (!(largest <= 0x1p60F && m >= 0x1p-30F && m <= 0x1p30F)) return std::nullopt;

    WideRay out; // NOLINT(*-member-init): every member is written below
    out.axes[0] = map_planes(o.x, d.x, std::abs(d.x) <= e * m ? largest : sizes.x, m, 0);
    out.axes[1] = map_planes(o.y, d.y, std::abs(d.y) <= e * m ? largest : sizes.y, m, 1);
    out.axes[2] = map_planes(o.z, d.z, std::abs(d.z) <= e * m ? largest : sizes.z, m, 2);
    out.t_min = ray.t_min + 0.0F;
    out.t_max = ray.t_max;

    const auto bytes = [](int axis) {
        return static_cast<std::size_t>(axis) * sizeof(TriangleBlock::vertices[0][0]);
    };
    out.x = bytes(x);
    out.y = bytes(y);
    out.z = bytes(z);
    out.origin_x = o[x];
    out.origin_y = o[y];
    out.origin_z = o[z];
    out.inverse_z = 1 / d[z];
    out.shear_x = d[x] / d[z];
    out.shear_y = d[y] / d[z];

    constexpr float up = 1 + 0x1p-10F; // for the roundings of the bounds themselves
    const float depth = largest_size(box.lo[z] - o[z], box.hi[z] - o[z]) * up;
    const float r = (depth * up + tree.largest_doubled_extent) * up;
    out.edge_error_scale = 24 * e * r * up;
    out.edge_error_shift = (e * r) * (e * (192 * depth + 48 * r)) * up + 0x1p-120F;
    const float slowness = std::abs(out.inverse_z) * up;
    out.t_error_scale = 5 * slowness;
    out.t_error_slope = 16 * e * depth * slowness;
    out.t_error_shift = (32 * e * depth + 0x1p-120F) * slowness;
    out.excluded = ray.excluded;
    return out;
}

} // namespace raywise::simd
