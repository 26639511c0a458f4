// The triangles of a mesh as the build of a pencil grid reads them.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <hwy/cache_control.h>

#include <cstddef>
#include <cstdint>
#include <vector>

namespace raywise::pencil_detail {

/// World vertices of all triangles, 9 floats each: x of v0, v1, v2, then y, then z.
class Records {
public:
    Records(const TriangleView& triangles, const Executor& executor);

    /// Of the triangles that are finite, ascending.
    [[nodiscard]] const std::vector<PrimId>& ids() const { return ids_; }

    /// Of the finite triangles.
    [[nodiscard]] const Aabb& bounds() const { return bounds_; }

    /// The largest magnitude of a coordinate of theirs.
    [[nodiscard]] double greatest() const;

    /// The largest difference of a coordinate of theirs from that of the apex.
    [[nodiscard]] double farthest_from(const Vec3d& apex) const;

    [[nodiscard]] Vec3d vertex(PrimId id, std::size_t corner) const {
        const float* record = values_.get() + to_index(id) * floats;
        return to_double(Vec3{record[corner], record[3 + corner], record[6 + corner]});
    }

    /// Asks for a triangle ahead of its use.
    void prefetch(PrimId id) const {
        const float* record = values_.get() + to_index(id) * floats;
        hwy::Prefetch(record);
        hwy::Prefetch(record + floats - 1);
    }

private:
    static constexpr std::size_t floats = 9;

    LargeBuffer<float> values_;
    std::vector<PrimId> ids_;
    Aabb bounds_;
};

} // namespace raywise::pencil_detail
