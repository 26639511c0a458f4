// How much of the rays two siblings share: the traversal visits both for those. After [Falcone24];
// the sampled form is ours.
#pragma once

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <vector>

namespace raywise {

/// Mass of the rays that meet one box, the other, and both. In one unit, each >= 0.
struct PairMass {
    double left = 0;
    double right = 0;
    double shared = 0;
};

/// The levels up to which the thesis reports cumulative overlap, the root being level 0.
inline constexpr std::array reported_levels{4, 7, 10, 15};

/// Overlap of the siblings below the inner nodes of each level.
class SiblingOverlap {
public:
    /// Adds the children of an inner node at `level` >= 0. A pair whose smaller mass is 0 adds
    /// nothing.
    void add(int level, const PairMass& mass);
    SiblingOverlap& operator+=(const SiblingOverlap& other);

    /// Levels that have inner nodes.
    [[nodiscard]] int levels() const { return static_cast<int>(sums_.size()); }

    /// Shared mass over the smaller sibling's mass, both summed over the inner nodes of the level;
    /// 0 where there are none. In [0, 1] when the masses are exact.
    [[nodiscard]] double at(int level) const;

    /// The same over all levels up to and including `level`.
    [[nodiscard]] double up_to(int level) const;

    [[nodiscard]] double all() const { return up_to(levels()); }

private:
    struct Sums {
        double shared = 0;
        double smaller = 0;
    };

    std::vector<Sums> sums_; ///< by level
};

/// Overlap under `mass`, a function (const Aabb& left, const Aabb& right) -> PairMass. Calls it
/// once per inner node.
template <class Mass>
    requires std::is_invocable_r_v<PairMass, const Mass&, const Aabb&, const Aabb&>
[[nodiscard]] SiblingOverlap measure_overlap(const Bvh& tree, const Mass& mass);

/// Whether shadows are cut to the window that the rays come from.
enum class Culling : std::uint8_t {
    culled,   ///< only rays that exist count
    unculled, ///< the whole shadow
};

/// Overlap as the rays of a distribution see it: the common part of the siblings' shadows. nullopt
/// where a shadow does not tell the mass: uniform and measured rays, radial ones without a window,
/// with a radius, or of an emission other than pinhole (with MeasureMode::thesis every emission is
/// taken for a pinhole). Use a sample of the rays there. Unculled, pairs of which a box reaches the
/// plane of the eye have no bounded shadow and add nothing.
[[nodiscard]] std::optional<SiblingOverlap> measure_overlap(
    const Bvh& tree,
    const Distribution& distribution,
    Culling culling = Culling::culled,
    MeasureMode mode = MeasureMode::exact
);

/// Overlap under a sample of rays: the share of the rays that meet both boxes, whatever the
/// distribution. Rays count with their whole line from t_min to t_max. The same for any number of
/// threads. O(rays x nodes met).
[[nodiscard]] SiblingOverlap measure_overlap(
    const Bvh& tree,
    std::span<const Ray> rays,
    const Executor& executor = serial_executor()
);

} // namespace raywise

#include <raywise/analysis/overlap.inl.hpp> // IWYU pragma: export
