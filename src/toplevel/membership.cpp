#include <raywise/toplevel/membership.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/scene/scene.hpp>

#include <cstddef>
#include <vector>

namespace raywise {
namespace {

bool has_vertex_in(const Region& region, const Triangle& triangle) {
    return contains(region, to_double(triangle.v0)) || contains(region, to_double(triangle.v1)) ||
           contains(region, to_double(triangle.v2));
}

} // namespace

std::vector<PrimId> members_of(
    const TriangleView& triangles,
    const Region& region,
    const MembershipParams& params,
    const Executor& executor
) {
    if (!(params.margin >= 1e-6 && params.margin <= 1)) {
        throw Error("membership: margin must be in [1e-6, 1]");
    }
    const bool by_overlap = params.rule == Membership::overlap;
    const Region wide = by_overlap ? inflated(region, params.margin * diameter(region)) : region;
    const Aabb wide_bounds = bounds(wide);
    const auto is_member = [&](const Triangle& triangle) {
        // The box first: it rejects most of a large scene.
        if (!overlaps(wide_bounds, bounds(triangle))) return false;
        const bool inside = by_overlap ? overlaps(wide, triangle) : has_vertex_in(wide, triangle);
        return inside && !is_degenerate(triangle);
    };

    // One list per chunk, joined in order, so that the result does not depend on the threads.
    constexpr std::size_t chunk = 4096;
    std::vector<std::vector<PrimId>> parts((triangles.size() + chunk - 1) / chunk);
    executor.for_each_chunk(triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<PrimId>& part = parts[begin / chunk];
        for (std::size_t i = begin; i < end; ++i) {
            if (is_member(triangles[to_prim(i)])) part.push_back(to_prim(i));
        }
    });

    std::size_t count = 0;
    for (const auto& part : parts)
        count += part.size();
    std::vector<PrimId> members;
    members.reserve(count);
    for (const auto& part : parts)
        members.insert(members.end(), part.begin(), part.end());
    return members;
}

} // namespace raywise
