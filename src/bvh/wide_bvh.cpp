#include <raywise/bvh/wide_bvh.hpp>

#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>

namespace raywise {

float doubled_extent(const Triangle& triangle) {
    const Vec3 size = bounds(triangle).size();
    // The subtraction was rounded; 2^-20 covers that and the product's rounding.
    return 2 * std::max({size.x, size.y, size.z}) * (1 + 0x1p-20F);
}

void TriangleBlock::set(std::size_t lane, const Triangle& triangle, PrimId prim) {
    const Vec3* const corners[3] = {&triangle.v0, &triangle.v1, &triangle.v2};
    for (std::size_t i = 0; i < 3; ++i) {
        vertices[i][0][lane] = corners[i]->x;
        vertices[i][1][lane] = corners[i]->y;
        vertices[i][2][lane] = corners[i]->z;
    }
    prims[lane] = prim;
    doubled_extents[lane] = doubled_extent(triangle);
}

void TriangleBlock::clear(std::size_t lane) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    for (auto& vertex : vertices)
        for (auto& axis : vertex)
            axis[lane] = nan;
    prims[lane] = no_prim;
    doubled_extents[lane] = 0;
}

} // namespace raywise
