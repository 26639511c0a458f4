// Slots with gaps between them: how a build with spatial splits finds room, and closes ranks.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise {

/// Slots for further references: `duplication` per triangle, but no more than node links can reach.
[[nodiscard]] std::size_t room_for(std::size_t count, double duplication);

/// A tree over the slots that hold a primitive, in their order; leaves among `nodes` point to slots
/// by their place in `slots`.
[[nodiscard]] Bvh
close_ranks(std::vector<Node> nodes, std::span<const PrimId> slots, const Executor& executor);

} // namespace raywise
