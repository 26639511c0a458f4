// What is asked of the speed beside Embree.
#pragma once

#include "bench/rows.hpp"

#include <optional>

namespace raywise::app {

/// Asked of a kind of rays beside a peer: a geometric mean over the scenes, and the least of any.
struct Goal {
    double mean = 1;
    double worst = 1;
};

/// Nothing where no goal is set: batches of rays that are not exact.
[[nodiscard]] constexpr std::optional<Goal> goal_of(RayKind kind, Peer peer) {
    if (kind == RayKind::exact) return peer == Peer::single ? Goal{4, 2} : Goal{2, 1.2};
    if (peer == Peer::best) return std::nullopt;
    return kind == RayKind::near_affine ? Goal{1.5, 1} : Goal{1, 0.9};
}

} // namespace raywise::app
