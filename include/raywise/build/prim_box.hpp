// What a builder moves around: a primitive's box and id in 32 bytes.
#pragma once

#include <raywise/build/quad.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/aabb.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace raywise {

/// The id travels in the fourth lanes as two small whole numbers: its bits taken as a float would
/// be denormal, and sums of denormals are slow.
struct alignas(32) PrimBox {
    Quad lo;
    Quad hi;

    /// Twice the center: sums, unlike halves, are exact enough to keep tiny boxes apart.
    [[nodiscard]] Quad centroid() const { return lo + hi; }

    [[nodiscard]] PrimId id() const {
        return static_cast<PrimId>(
            static_cast<std::uint32_t>(lo[3]) | static_cast<std::uint32_t>(hi[3]) << 16U
        );
    }
};

static_assert(sizeof(PrimBox) == 32, "two fill a cache line");

/// Two arrays of the same length, since a stable partition reads one and writes the other. The
/// second is not initialized.
struct PrimBoxes {
    LargeBuffer<PrimBox> items; ///< by id; -0 made +0, so that minima do not depend on order
    LargeBuffer<PrimBox> spare;
};

/// Throws Error, naming the first offender, unless every box is valid with coordinates in
/// [-2^60, 2^60] and there are at most 2^31 - 1 of them.
void check_boxes(std::span<const Aabb> boxes);

/// The boxes as a builder wants them, and behind them `room` that is not initialized; throws as
/// check_boxes does.
[[nodiscard]] PrimBoxes
load_boxes(std::span<const Aabb> boxes, const Executor& executor, std::size_t room = 0);

} // namespace raywise
