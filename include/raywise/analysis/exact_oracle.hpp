// The right answers, fast enough to check millions of rays: one plain tree over everything and the
// exact kernel. Equal to brute force for every ray (closest_hit.hpp); far simpler than what it
// checks.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/trace/triangles.hpp>

#include <optional>
#include <span>

namespace raywise {

/// Owns a copy of the triangles. Const queries are thread-safe; a ray that is not `is_valid`
/// misses.
class ExactOracle {
public:
    /// Coordinates must be finite and within `max_coordinate`; throws Error otherwise.
    /// O(n log n).
    explicit ExactOracle(
        const TriangleView& triangles,
        const Executor& executor = serial_executor()
    );

    /// The hit with the smallest (t, id) in [t_min, t_max].
    [[nodiscard]] std::optional<Hit> closest_hit(const Ray& ray) const;

    [[nodiscard]] bool any_hit(const Ray& ray) const;

    /// A miss is `Hit{}`. Throws Error when the sizes differ.
    void closest_hits(
        std::span<const Ray> rays,
        std::span<Hit> hits,
        const Executor& executor = serial_executor()
    ) const;

    /// occluded[i] tells whether rays[i] has a hit. Throws Error when the sizes differ.
    void any_hits(
        std::span<const Ray> rays,
        std::span<bool> occluded,
        const Executor& executor = serial_executor()
    ) const;

private:
    Bvh tree_;
    PackedTriangles triangles_;
};

} // namespace raywise
