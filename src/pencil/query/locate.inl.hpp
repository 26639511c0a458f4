// From a ray to its place in a face, and to its cell. Included once for every instruction set.
#if defined(RAYWISE_PENCIL_QUERY_LOCATE) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_LOCATE
#undef RAYWISE_PENCIL_QUERY_LOCATE
#else
#define RAYWISE_PENCIL_QUERY_LOCATE
#endif

#include "pencil/face_map.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/kernels.hpp"

#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Which way a ray of the pencil runs.
enum class Heading : std::uint8_t { to_emitter, from_emitter };

/// The place of a ray in a face, in units.
struct Spot {
    const Face* face;
    std::array<std::int32_t, 4> units;

    [[nodiscard]] HWY_INLINE std::int32_t u() const { return units[0]; }

    [[nodiscard]] HWY_INLINE std::int32_t v() const { return units[1]; }

    /// No hit is deeper.
    [[nodiscard]] HWY_INLINE std::int32_t deepest() const { return units[2]; }

    /// What is passed through and not deeper is hit; or `nothing_sure`.
    [[nodiscard]] HWY_INLINE std::int32_t sure() const { return units[3]; }
};

constexpr std::int32_t nothing_sure = -(1 << 29);

/// Of depths, in units.
constexpr std::int32_t rounding = 4;

constexpr FaceMap::Lanes depth_limit{0x1p30, 0x1p30, deepest, deepest};

/// Radial: what is divided by the apex's distance along z from the origin, and what by that from
/// the ray's end. A ray from the apex begins at none.
template <Heading heading>
constexpr FaceMap::Lanes begin =
    heading == Heading::to_emitter ? FaceMap::Lanes{1, 1, 1, 1} : FaceMap::Lanes{1, 1, 0, 0};

/// An end at or behind the apex is as near as can be.
constexpr FaceMap::Lanes least_distance{0, 0, 0x1p-1000, 0x1p-1000};

enum class Where : std::uint8_t {
    inside,
    outside, ///< where nothing is
    unknown, ///< too far away to say
};

/// The face of a direction from the apex, and how far it goes along its axis. Without branches:
/// lamps look everywhere.
HWY_INLINE std::size_t face_of(const Vec3d& seen, double& longest) {
    const hn::CappedTag<double, 1> d;
    const auto x = hn::Set(d, seen.x);
    const auto y = hn::Set(d, seen.y);
    const auto z = hn::Set(d, seen.z);
    const auto across = hn::Max(hn::Abs(x), hn::Abs(y));
    const auto size = hn::Max(across, hn::Abs(z));
    longest = hn::GetLane(size);
    const auto is_z = hn::Gt(hn::Abs(z), across);
    const auto is_x = hn::Ge(hn::Abs(x), size);
    const auto is_negative =
        hn::Lt(hn::IfThenElse(is_x, x, hn::IfThenElse(is_z, z, y)), hn::Zero(d));
    const auto is_y = hn::Not(hn::Or(is_x, is_z));
    return 4 * hn::CountTrue(d, is_z) + 2 * hn::CountTrue(d, is_y) + hn::CountTrue(d, is_negative);
}

/// A ray of the grid's pencil: of its direction only what `Heading` leaves open. Points to what is
/// in memory already.
struct Segment {
    const Vec3& origin;
    const Vec3& direction; ///< away from a radial emitter; anything for others
    float t_min, t_max;
};

HWY_INLINE Segment segment_of(const Ray& ray) {
    return {ray.origin, ray.direction, ray.t_min, ray.t_max};
}

/// Hits at an infinite t do not count, and an infinite length times nothing would be no place. What
/// is no number becomes the largest, too.
HWY_INLINE float finite(float t) {
    return std::min(std::numeric_limits<float>::max(), t);
}

/// Why a ray has no place in a face. Apart, as it is rare.
template <Heading heading>
HWY_NOINLINE Where where_else(const Grid& grid, const Segment& ray, const FaceMap& map) {
    double z = 0;
    if (grid.pencil.kind() == Pencil::Kind::parallel)
        z = static_cast<double>(ray.origin[map.axis]);
    else if (heading == Heading::to_emitter)
        z = static_cast<double>(ray.origin[map.axis]) - grid.apex[map.axis];
    return std::abs(z) <= map.reach ? Where::outside : Where::unknown;
}

template <Heading heading>
HWY_INLINE Where locate(const Grid& grid, const Segment& ray, Spot& spot) {
    const hn::CappedTag<double, 4> d;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    // Not by scalar conversions: g++ lets those wait for what the last ray left in a register.
    const auto to_doubles = [&](float x) HWY_ATTR {
        return hn::PromoteTo(d, hn::Set(hn::Rebind<float, decltype(d)>(), x));
    };
    const bool is_parallel = grid.pencil.kind() == Pencil::Kind::parallel;
    const bool is_direction = !is_parallel && heading == Heading::from_emitter;
    const Vec3& from = is_direction ? ray.direction : ray.origin;
    auto x = to_doubles(from.x);
    auto y = to_doubles(from.y);
    auto z = to_doubles(from.z);
    std::size_t face = 0;
    double longest = 1;
    if (!is_parallel) {
        if (heading == Heading::to_emitter) {
            x = hn::Sub(x, hn::Set(d, grid.apex.x));
            y = hn::Sub(y, hn::Set(d, grid.apex.y));
            z = hn::Sub(z, hn::Set(d, grid.apex.z));
        }
        face = face_of({hn::GetLane(x), hn::GetLane(y), hn::GetLane(z)}, longest);
    }
    spot.face = &grid.faces[face];
    const FaceMap& map = spot.face->map;
    // The rounded direction of a shadow ray is as long up to 2^-23.
    const float t = finite(heading == Heading::to_emitter ? ray.t_min : ray.t_max);
    const auto length = hn::Mul(to_doubles(t), hn::Set(d, longest));

    bool is_inside = true;
    for (std::size_t lane = 0; lane < 4; lane += hn::Lanes(d)) {
        const auto load = [&](const FaceMap::Lanes& lanes)
                              HWY_ATTR { return hn::LoadU(d, lanes.data() + lane); };
        const auto along = load(heading == Heading::to_emitter ? map.toward : map.away);
        auto sum = load(is_parallel ? map.columns[3] : map.dividend);
        sum = hn::MulAdd(load(map.columns[2]), z, sum);
        sum = hn::MulAdd(load(map.columns[1]), y, sum);
        sum = hn::MulAdd(load(map.columns[0]), x, sum);
        if (!is_parallel) {
            const auto end =
                hn::MulAdd(along, length, hn::Mul(load(begin<heading>), hn::Set(d, longest)));
            const auto distance = hn::Max(end, load(least_distance));
            const auto inverse = hn::Div(hn::Set(d, 1.0), distance);
            sum = hn::MulAdd(sum, inverse, load(map.columns[3]));
        }
        is_inside &=
            hn::AllTrue(d, hn::And(hn::Ge(sum, load(map.least)), hn::Lt(sum, load(map.limit))));
        if (is_parallel) sum = hn::MulAdd(along, length, sum);
        // Places are within these limits, too, but for depths.
        sum = hn::Max(hn::Min(sum, load(depth_limit)), hn::Zero(d));
        hn::StoreU(hn::DemoteTo(integers, sum), integers, spot.units.data() + lane);
    }
    if (!is_parallel && heading == Heading::to_emitter) is_inside &= longest <= map.reach;
    if (!is_inside) [[unlikely]]
        return where_else<heading>(grid, ray, map);

    bool is_whole = ray.t_max >= map.whole_t;
    if constexpr (heading == Heading::from_emitter) {
        const double start = is_parallel ? static_cast<double>(ray.origin[map.axis]) * map.sign : 0;
        const double speed = is_parallel ? static_cast<double>(map.speed) : longest;
        is_whole = start + static_cast<double>(ray.t_min) * speed * (1 + 0x1p-20) < map.front;
    }
    spot.units[3] = is_whole ? spot.units[3] - rounding : nothing_sure;
    if (heading == Heading::to_emitter && !is_parallel &&
        static_cast<double>(ray.t_min) > map.most_t) [[unlikely]] {
        spot.units[2] = deepest;
        spot.units[3] = nothing_sure;
    }
    return Where::inside;
}

/// The list that a ray must look through, or a verdict without one. Small, so that it stays in
/// registers: g++ copies larger ones in parts that wait for each other.
struct Leaf {
    const Cell* cell;
    std::int32_t shift;   ///< its side is 2^shift units
    std::int32_t verdict; ///< a Verdict, or `open`

    static constexpr std::int32_t open = -1;

    [[nodiscard]] HWY_INLINE bool has_verdict() const { return verdict != open; }
};

/// Where in its cell of side 2^shift a place is, in half cells from the middle, times 2^15.
HWY_INLINE std::int16_t place_in_cell(std::int32_t units, int shift) {
    return static_cast<std::int16_t>(
        (static_cast<std::uint32_t>(units) << (top_shift - shift)) ^ 0x8000U
    );
}

HWY_INLINE const Cell* top_cell(const Spot& spot) {
    const Face& face = *spot.face;
    return face.cells + static_cast<std::ptrdiff_t>(spot.v() >> top_shift) * face.width +
           (spot.u() >> top_shift);
}

/// What a cell of side 2^shift says of a ray at once. `decides_hits`: whether one that passes two
/// triangles is "hit".
template <bool decides_hits>
HWY_INLINE Leaf look_at(const Cell& cell, int shift, const Spot& spot) {
    // In 2^-15 of the cell.
    const auto along = [&](std::int32_t units) {
        return static_cast<std::int32_t>(
            ((static_cast<std::uint32_t>(units) << (top_shift - shift)) & 0xFFFFU) >> 1U
        );
    };
    const std::int32_t plane = cell.slope_u * along(spot.u()) + cell.slope_v * along(spot.v());
    const bool is_miss = spot.deepest() - cell.base < (plane >> 15) * (1 << cell.shift);
    const bool is_hit =
        decides_hits && (spot.sure() >> cover_shift) > static_cast<std::int32_t>(cell.cover);
    constexpr auto miss = static_cast<std::int32_t>(Verdict::miss);
    constexpr auto hit = static_cast<std::int32_t>(Verdict::hit);
    return {&cell, shift, is_miss ? miss : is_hit ? hit : Leaf::open};
}

template <bool decides_hits, class Count>
HWY_INLINE Leaf find_leaf(const Grid& grid, const Spot& spot, Count count) {
    count.cell();
    Leaf leaf = look_at<decides_hits>(*top_cell(spot), top_shift, spot);
    while (!leaf.has_verdict() && (leaf.cell->link & Cell::split_mark) != 0) [[unlikely]] {
        count.cell();
        const int shift = leaf.shift - split_bits;
        const auto* const children = reinterpret_cast<const Cell*>(
            grid.lists + std::size_t{leaf.cell->link & ~Cell::split_mark} * 16
        );
        const int child = ((spot.v() >> shift) & 3) * 4 + ((spot.u() >> shift) & 3);
        leaf = look_at<decides_hits>(children[child], shift, spot);
    }
    return leaf;
}

/// Whether the leaf's list has all triangles that the ray may meet at most so deep.
HWY_INLINE bool is_complete(std::int32_t deepest_hit, const Leaf& leaf) {
    return (deepest_hit >> cover_shift) <= static_cast<std::int32_t>(leaf.cell->cover);
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
