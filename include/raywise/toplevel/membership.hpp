// Which triangles belong to an influence area: all that overlap its region, a little inflated.
#pragma once

#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/triangle_view.hpp>

#include <cstdint>
#include <vector>

namespace raywise {

/// How membership is decided.
enum class Membership : std::uint8_t {
    overlap, ///< the triangle overlaps the region: what exact answers need
    /// One of its vertices is in the region: the thesis's rule, which loses the large triangles
    /// that span a region. For faithful runs; answers may be wrong.
    vertices,
};

struct MembershipParams {
    Membership rule = Membership::overlap;
    /// The region is inflated by this share of its diameter, so that a hit whose rounded t lies
    /// before the exit belongs to the area too; in [1e-6, 1]. Not applied to `vertices`.
    double margin = 1e-4;
};

/// The triangles of the region in ascending order: every one that the rule takes, and with
/// `overlap` possibly a few that touch only by rounding. Triangles of zero area are dropped (they
/// are never hit). Parallel, the same for any number of threads; O(triangles). Throws Error for
/// parameters out of range.
[[nodiscard]] std::vector<PrimId> members_of(
    const TriangleView& triangles,
    const Region& region,
    const MembershipParams& params = {},
    const Executor& executor = serial_executor()
);

} // namespace raywise
