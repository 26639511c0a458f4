#include "geometry/detail/expansion.hpp"
#include "pencil/inversion/facing.hpp"

#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

namespace raywise::detail {

int exact_facing(Vec3 direction, const Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    const auto px = difference(b.x, a.x), py = difference(b.y, a.y), pz = difference(b.z, a.z);
    const auto qx = difference(c.x, a.x), qy = difference(c.y, a.y), qz = difference(c.z, a.z);
    const auto x = compress(py * qz - pz * qy) * difference(direction.x, 0.0F);
    const auto y = compress(pz * qx - px * qz) * difference(direction.y, 0.0F);
    const auto z = compress(px * qy - py * qx) * difference(direction.z, 0.0F);
    return compress(x + y + z).sign();
}

} // namespace raywise::detail
