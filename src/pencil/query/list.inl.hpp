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
    std::int16_t deepest; ///< what is behind is not met
    std::int16_t sure;    ///< what is before, and passed through, is met
};

/// Bit i is for reference i of a chunk. What is sure is possible, too.
struct Marks {
    std::uint32_t possible;
    std::uint32_t sure;
};

/// Depths of the references that are marked: they are met between the two, if at all.
struct Depths {
    alignas(64) std::array<std::int16_t, chunk_size> least;
    alignas(64) std::array<std::int16_t, chunk_size> greatest;
};

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

#else

using Words = hn::CappedTag<std::int16_t, chunk_size>;

template <class V>
HWY_INLINE V saturated_sum(V a, V b) {
    return hn::SaturatedAdd(a, b);
}

template <class V>
HWY_INLINE V product(V a, V b) {
    return hn::MulFixedPoint15(a, b);
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
    const std::size_t stride = 2 * padded(size);
    const auto u = hn::Set(d, probe.u);
    const auto v = hn::Set(d, probe.v);
    Marks marks{0, 0};
    for (std::size_t i = 0; i < chunk_size; i += hn::Lanes(d)) {
        // Three rows at a time.
        const auto row = [&](std::size_t k) HWY_ATTR {
            const std::byte* const group = chunk + k / 3 * (3 * stride) + 2 * i;
            return hn::LoadU(d, reinterpret_cast<const std::int16_t*>(group + k % 3 * stride));
        };
        const auto edge = [&](std::size_t k) HWY_ATTR {
            const auto change =
                hn::Add(product(row(3 * k + edge_u), u), product(row(3 * k + edge_v), v));
            return saturated_sum(row(3 * k + edge_at), change);
        };
        const auto inside = hn::Min(hn::Min(edge(0), edge(1)), edge(2));
        const auto least =
            hn::Add(row(depth_at), hn::Add(product(row(depth_u), u), product(row(depth_v), v)));
        const auto thick = row(thickness);
        const auto end = hn::Set(d, endless);
        const auto greatest = hn::IfThenElse(hn::Lt(thick, end), saturated_sum(least, thick), end);
        const auto is_behind = hn::Gt(least, hn::Set(d, probe.deepest));
        const auto is_possible =
            hn::AndNot(is_behind, hn::Gt(inside, hn::Set(d, std::int16_t{-edge_doubt})));
        const auto is_sure = hn::And(
            hn::And(is_possible, hn::Gt(inside, hn::Set(d, std::int16_t{edge_doubt - 1}))),
            hn::Lt(greatest, hn::Set(d, probe.sure))
        );
        marks.possible |= bits_of_words(is_possible) << i;
        marks.sure |= bits_of_words(is_sure) << i;
        if (depths != nullptr) {
            hn::Store(least, d, depths->least.data() + i);
            hn::Store(greatest, d, depths->greatest.data() + i);
        }
    }
    const std::uint32_t used = 0xFFFFFFFFU >> (chunk_size - size);
    return {marks.possible & used, marks.sure & used};
}

/// A query's way through a list.
struct Walk {
    const std::byte* at; ///< the chunk
    std::size_t left;    ///< references from there on
    std::int32_t base;
    int shift;
    Probe probe;

    [[nodiscard]] HWY_INLINE std::size_t size() const { return std::min(left, chunk_size); }

    [[nodiscard]] HWY_INLINE Marks marks() const { return meet(at, size(), probe, nullptr); }

    [[nodiscard]] HWY_INLINE Marks marks(Depths& depths) const {
        return meet(at, size(), probe, &depths);
    }

    [[nodiscard]] HWY_INLINE PrimId id(std::uint32_t bits) const {
        PrimId id; // NOLINT(*-member-init): written next
        std::memcpy(
            &id,
            at + 2 * list_rows * padded(size()) +
                sizeof id * static_cast<std::size_t>(std::countr_zero(bits)),
            sizeof id
        );
        return id;
    }

    /// No hit is deeper, in units.
    [[nodiscard]] HWY_INLINE std::int32_t deepest(const Spot& spot) const {
        if (probe.deepest == endless) return spot.deepest();
        const std::int64_t limit = base + ((std::int64_t{probe.deepest} + 1) << shift);
        return static_cast<std::int32_t>(std::min<std::int64_t>(limit, spot.deepest()));
    }

    /// Goes to the next chunk, if one may matter.
    [[nodiscard]] HWY_INLINE bool advance() {
        if (left <= chunk_size) return false;
        left -= chunk_size;
        at += chunk_bytes(chunk_size);
        std::int16_t least = 0;
        std::memcpy(&least, at, sizeof least);
        at += chunk_head_bytes;
        return least <= probe.deepest;
    }
};

HWY_INLINE Walk walk(const Grid& grid, const Leaf& leaf, const Spot& spot) {
    const std::byte* const at = grid.lists + std::size_t{leaf.cell->link} * 16;
    ListHead head;
    std::memcpy(&head, at, sizeof head);
    const auto depth = [&](std::int32_t units) {
        return static_cast<std::int16_t>(
            std::clamp((units - head.base) >> head.shift(), -32768, 32767)
        );
    };
    return {
        at + sizeof head,
        head.count(),
        head.base,
        head.shift(),
        {place_in_cell(spot.u(), leaf.shift),
         place_in_cell(spot.v(), leaf.shift),
         depth(spot.deepest()),
         depth(spot.sure())}
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
