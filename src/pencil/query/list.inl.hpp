// A query in a cell's list: which references the ray surely meets and which it may, 32 at a time.
// Included once for every instruction set.
#if defined(RAYWISE_PENCIL_QUERY_LIST) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_LIST
#undef RAYWISE_PENCIL_QUERY_LIST
#else
#define RAYWISE_PENCIL_QUERY_LIST
#endif

#include "pencil/grid_data.hpp"
#include "pencil/query/locate.inl.hpp"

#include <raywise/core/ids.hpp>

#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// A query's place in a cell and its depths, as the list has them.
struct Probe {
    std::int16_t u, v;
    std::int16_t before;     ///< what is met so many steps from `deepest`, below zero, is met
    std::uint32_t sure_bits; ///< 0 when nothing is sure, else all
    std::int32_t deepest;    ///< units; what is behind is not met
};

/// Bit i is for reference i of a chunk. What is sure is possible, too.
struct Marks {
    std::uint32_t possible;
    std::uint32_t sure;
};

/// Depths of the references that are marked, in units: they are met between the two, if at all.
struct Depths {
    alignas(64) std::array<std::int32_t, chunk_size> least;
    alignas(64) std::array<std::int32_t, chunk_size> greatest;
};

/// Of the references from `base` and `shift` on: how many steps of 2^shift a depth is beyond the
/// base, rounded down and limited to 16 bits; and where the depths base + steps * 2^shift lie.
#if HWY_TARGET == HWY_SCALAR

using Words = hn::CappedTag<std::int16_t, 1>;

template <class V>
HWY_INLINE V saturated_sum(V a, V b) {
    const Words d;
    const int sum = int{hn::GetLane(a)} + int{hn::GetLane(b)};
    return hn::Set(d, static_cast<std::int16_t>(std::clamp(sum, -32768, 32767)));
}

template <class V>
HWY_INLINE V product(V a, V b) {
    const Words d;
    const int wide = int{hn::GetLane(a)} * int{hn::GetLane(b)};
    return hn::Set(d, static_cast<std::int16_t>((wide + 0x4000) >> 15));
}

HWY_INLINE std::int32_t number_at(const std::byte* at) {
    std::int32_t number = 0;
    std::memcpy(&number, at, sizeof number);
    return number;
}

/// Less than 32 also beyond the chunk, where anything stands.
HWY_INLINE int shift_at(const std::byte* at) {
    return static_cast<int>(*at) & 31;
}

HWY_INLINE hn::Vec<Words>
steps_to(std::int32_t depth, const std::byte* base, const std::byte* shift) {
    const std::int64_t steps = (std::int64_t{depth} - number_at(base)) >> shift_at(shift);
    return hn::Set(
        Words(), static_cast<std::int16_t>(std::clamp<std::int64_t>(steps, -32768, 32767))
    );
}

HWY_INLINE void store_depths(
    hn::Vec<Words> steps,
    const std::byte* base,
    const std::byte* shift,
    std::int32_t* depths
) {
    const std::int64_t beyond = std::int64_t{hn::GetLane(steps)} << shift_at(shift);
    *depths = static_cast<std::int32_t>(number_at(base) + beyond);
}

#else

using Words = hn::CappedTag<std::int16_t, chunk_size>;
using HalfWords = hn::Half<Words>;
using Integers = hn::Rebind<std::int32_t, HalfWords>;

template <class V>
HWY_INLINE V saturated_sum(V a, V b) {
    return hn::SaturatedAdd(a, b);
}

template <class V>
HWY_INLINE V product(V a, V b) {
#if HWY_TARGET == HWY_EMU128
    // There, MulFixedPoint15 overflows for -1 * -1, which may stand beyond a chunk.
    const Words d;
    std::array<std::int16_t, hn::MaxLanes(Words())> x, y; // NOLINT(*-member-init): written next
    hn::StoreU(a, d, x.data());
    hn::StoreU(b, d, y.data());
    for (std::size_t i = 0; i < x.size(); ++i)
        x[i] = static_cast<std::int16_t>((std::int64_t{x[i]} * y[i] + 0x4000) >> 15);
    return hn::LoadU(d, x.data());
#else
    return hn::MulFixedPoint15(a, b);
#endif
}

HWY_INLINE hn::Vec<Integers> bases_at(const std::byte* at) {
    return hn::LoadU(Integers(), reinterpret_cast<const std::int32_t*>(at));
}

/// Less than 32 also beyond the chunk, where anything stands.
HWY_INLINE hn::Vec<Integers> shifts_at(const std::byte* at) {
    const hn::Rebind<std::uint8_t, Integers> bytes;
    const auto shifts =
        hn::PromoteTo(Integers(), hn::LoadU(bytes, reinterpret_cast<const std::uint8_t*>(at)));
    return hn::And(shifts, hn::Set(Integers(), 31));
}

HWY_INLINE hn::Vec<Words>
steps_to(std::int32_t depth, const std::byte* base, const std::byte* shift) {
    const auto half = [&](std::size_t first) HWY_ATTR {
        const auto beyond = hn::Sub(hn::Set(Integers(), depth), bases_at(base + 4 * first));
        return hn::DemoteTo(HalfWords(), hn::Shr(beyond, shifts_at(shift + first)));
    };
    return hn::Combine(Words(), half(hn::Lanes(HalfWords())), half(0));
}

HWY_INLINE void store_depths(
    hn::Vec<Words> steps,
    const std::byte* base,
    const std::byte* shift,
    std::int32_t* depths
) {
    const auto store = [&](hn::Vec<HalfWords> half, std::size_t first) HWY_ATTR {
        const auto beyond = hn::Shl(hn::PromoteTo(Integers(), half), shifts_at(shift + first));
        hn::Store(hn::Add(bases_at(base + 4 * first), beyond), Integers(), depths + first);
    };
    store(hn::LowerHalf(HalfWords(), steps), 0);
    store(hn::UpperHalf(HalfWords(), steps), hn::Lanes(HalfWords()));
}

#endif

template <class M>
HWY_INLINE std::uint32_t bits_of_words(M mask) {
    std::uint8_t bytes[8];
    const std::size_t size = hn::StoreMaskBits(Words(), mask, bytes);
    std::uint32_t bits = 0;
    std::memcpy(&bits, bytes, std::min(size, sizeof bits));
    return bits;
}

/// The values of `Row`, at the probe's place. `depths`: null, or where depths are written.
HWY_INLINE Marks
meet(const std::byte* chunk, std::size_t size, const Probe& probe, Depths* depths) {
    const Words d;
    const std::size_t stride = padded(size);
    const auto u = hn::Set(d, probe.u);
    const auto v = hn::Set(d, probe.v);
    Marks marks{0, 0};
    for (std::size_t i = 0; i < chunk_size; i += hn::Lanes(d)) {
        // Three rows at a time.
        const auto row = [&](std::size_t k) HWY_ATTR {
            const std::byte* const group = chunk + k / 3 * (6 * stride) + 2 * i;
            return hn::LoadU(
                d, reinterpret_cast<const std::int16_t*>(group + k % 3 * (2 * stride))
            );
        };
        const auto edge = [&](std::size_t k) HWY_ATTR {
            const auto change =
                hn::Add(product(row(3 * k + edge_u), u), product(row(3 * k + edge_v), v));
            return saturated_sum(row(3 * k + edge_at), change);
        };
        const auto inside = hn::Min(hn::Min(edge(0), edge(1)), edge(2));
        const std::byte* const base = chunk + 2 * depth_base * stride + 4 * i;
        const std::byte* const shift = chunk + 2 * depth_shift * stride + i;
        const auto depth = hn::Add(product(row(depth_u), u), product(row(depth_v), v));
        const auto deepest = steps_to(probe.deepest, base, shift);
        const auto doubt = hn::Set(d, std::int16_t{depth_doubt});
        const auto is_behind = hn::Gt(depth, saturated_sum(deepest, doubt));
        const auto is_before = hn::Lt(depth, saturated_sum(deepest, hn::Set(d, probe.before)));
        const auto is_possible =
            hn::AndNot(is_behind, hn::Gt(inside, hn::Set(d, std::int16_t{-edge_doubt})));
        const auto is_sure = hn::And(
            hn::And(is_possible, is_before),
            hn::Gt(inside, hn::Set(d, std::int16_t{edge_doubt - 1}))
        );
        marks.possible |= bits_of_words(is_possible) << i;
        marks.sure |= bits_of_words(is_sure) << i;
        if (depths != nullptr) {
            store_depths(hn::Sub(depth, doubt), base, shift, depths->least.data() + i);
            store_depths(hn::Add(depth, doubt), base, shift, depths->greatest.data() + i);
        }
    }
    const std::uint32_t used = 0xFFFFFFFFU >> (chunk_size - size);
    return {marks.possible & used, marks.sure & used & probe.sure_bits};
}

/// A query's way through a list.
struct Walk {
    const std::byte* at; ///< the chunk
    std::size_t left;    ///< references from there on
    Probe probe;

    [[nodiscard]] HWY_INLINE std::size_t size() const { return std::min(left, chunk_size); }

    [[nodiscard]] HWY_INLINE Marks marks() const { return meet(at, size(), probe, nullptr); }

    [[nodiscard]] HWY_INLINE Marks marks(Depths& depths) const {
        return meet(at, size(), probe, &depths);
    }

    [[nodiscard]] HWY_INLINE PrimId id(std::uint32_t bits) const {
        PrimId id{};
        std::memcpy(
            &id,
            at + 2 * prim_row * padded(size()) +
                sizeof id * static_cast<std::size_t>(std::countr_zero(bits)),
            sizeof id
        );
        return id;
    }

    /// Goes to the next chunk, if one may matter.
    [[nodiscard]] HWY_INLINE bool advance() {
        if (left <= chunk_size) return false;
        left -= chunk_size;
        at += chunk_bytes(chunk_size);
        std::int32_t least = 0;
        std::memcpy(&least, at, sizeof least);
        at += chunk_head_bytes;
        return least <= probe.deepest;
    }
};

HWY_INLINE Walk walk(const Grid& grid, const Leaf& leaf, const Spot& spot) {
    const std::byte* const at = grid.lists + std::size_t{leaf.cell->link} * 16;
    ListHead head{};
    std::memcpy(&head, at, sizeof head);
    const std::int32_t unsure = (spot.deepest() - spot.sure()) >> least_shift;
    const std::int32_t before = unsure + 1 + depth_doubt;
    return {
        at + sizeof head,
        head.count,
        {place_in_cell(spot.u(), leaf.shift),
         place_in_cell(spot.v(), leaf.shift),
         static_cast<std::int16_t>(-std::min(before, 32767)),
         before < 32767 ? ~std::uint32_t{0} : 0,
         spot.deepest()}
    };
}

/// Asks for the start of a leaf's list ahead of its use.
HWY_INLINE void prefetch_list(const Grid& grid, const Leaf& leaf) {
    const std::byte* at = grid.lists + std::size_t{leaf.cell->link} * 16;
    for (std::size_t line = 0; line < 8; ++line)
        hwy::Prefetch(at + 64 * line);
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
