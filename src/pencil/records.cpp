#include "pencil/records.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace raywise::pencil_detail {

Records::Records(const TriangleView& triangles, const Executor& executor)
    : values_(triangles.size() * floats) {
    struct Part {
        std::vector<PrimId> ids;
        Aabb bounds;
    };

    constexpr std::size_t chunk = 1 << 13;
    const std::size_t count = triangles.size();
    std::vector<Part> parts((count + chunk - 1) / chunk);
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        Part& part = parts[begin / chunk];
        part.ids.reserve(end - begin);
        for (std::size_t i = begin; i < end; ++i) {
            const Triangle t = triangles[to_prim(i)];
            float* to = values_.get() + i * floats;
            for (int axis = 0; axis < 3; ++axis) {
                *to++ = t.v0[axis];
                *to++ = t.v1[axis];
                *to++ = t.v2[axis];
            }
            if (!is_finite(t.v0) || !is_finite(t.v1) || !is_finite(t.v2)) continue;
            for (const Vec3& vertex : {t.v0, t.v1, t.v2})
                part.bounds = unite(part.bounds, vertex);
            part.ids.push_back(to_prim(i));
        }
    });
    ids_.reserve(count);
    for (const Part& part : parts) {
        ids_.insert(ids_.end(), part.ids.begin(), part.ids.end());
        bounds_ = unite(bounds_, part.bounds);
    }
}

double Records::greatest() const {
    return farthest_from({});
}

double Records::farthest_from(const Vec3d& apex) const {
    double farthest = 0;
    if (ids_.empty()) return farthest;
    for (const Vec3& corner : {bounds_.lo, bounds_.hi})
        for (int axis = 0; axis < 3; ++axis)
            farthest = std::max(farthest, std::abs(static_cast<double>(corner[axis]) - apex[axis]));
    return farthest;
}

} // namespace raywise::pencil_detail
