// The tree that queries run on, as plain data: nodes of eight boxes, leaves of blocks of four
// triangles. No heuristics. After [Wald08], [Ernst08].
#pragma once

#include <raywise/bvh/box_frame.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/large_vector.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>

#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace raywise {

/// What a slot of a wide node leads to: a node, or the first block of a leaf. As an address: how
/// many times 8 bytes from the first node or block, so that a query has no more to compute.
class WideRef {
public:
    static constexpr std::size_t max_nodes = std::size_t{1} << 26U;
    static constexpr std::size_t max_blocks = (std::size_t{1} << 31U) / 24;

    WideRef() = default;

    /// index < max_nodes.
    [[nodiscard]] static constexpr WideRef node(std::size_t index) {
        return WideRef(static_cast<std::uint32_t>(index * node_words));
    }

    /// index < max_blocks.
    [[nodiscard]] static constexpr WideRef leaf(std::size_t index) {
        return WideRef(static_cast<std::uint32_t>(index * block_words) | leaf_bit);
    }

    [[nodiscard]] static constexpr WideRef from_bits(std::uint32_t bits) { return WideRef(bits); }

    [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }

    [[nodiscard]] constexpr bool is_leaf() const { return (bits_ & leaf_bit) != 0; }

    /// Of a leaf's block, the one after it.
    [[nodiscard]] constexpr WideRef next_block() const {
        return WideRef(bits_ + static_cast<std::uint32_t>(block_words));
    }

    /// Into `nodes` or `blocks`.
    [[nodiscard]] constexpr std::size_t index() const {
        return words() / (is_leaf() ? block_words : node_words);
    }

    /// From the first node or block, in units of 8 bytes.
    [[nodiscard]] constexpr std::size_t words() const { return bits_ & ~leaf_bit; }

    friend constexpr bool operator==(WideRef, WideRef) = default;

private:
    static constexpr std::uint32_t leaf_bit = 0x80000000U;
    static constexpr std::size_t node_words = 32;
    static constexpr std::size_t block_words = 24;

    explicit constexpr WideRef(std::uint32_t bits) : bits_(bits) {}

    std::uint32_t bits_ = 0;
};

/// Up to eight children, by the planes of their boxes. A slot without a child has the empty box,
/// which no ray meets. The slots in use come first.
struct alignas(64) WideNode {
    static constexpr std::size_t width = 8;

    std::array<std::array<std::array<float, width>, 2>, 3> planes{
    }; ///< by axis, then lower and upper, then slot
    std::array<WideRef, width> children;
    std::array<std::uint32_t, 8> unused{}; ///< 0

    void set(std::size_t slot, const Aabb& box, WideRef child) {
        for (int axis = 0; axis < 3; ++axis) {
            auto& [lower, upper] = planes[static_cast<std::size_t>(axis)];
            lower[slot] = box.lo[axis];
            upper[slot] = box.hi[axis];
        }
        children[slot] = child;
    }

    void clear(std::size_t slot) { set(slot, Aabb{}, WideRef{}); }

    [[nodiscard]] Aabb box(std::size_t slot) const {
        return {
            {planes[0][0][slot], planes[1][0][slot], planes[2][0][slot]},
            {planes[0][1][slot], planes[1][1][slot], planes[2][1][slot]}
        };
    }

    [[nodiscard]] bool is_used(std::size_t slot) const {
        return planes[0][0][slot] <= planes[0][1][slot];
    }
};

static_assert(sizeof(WideNode) == 256, "four cache lines, of which a query reads all; see WideRef");

/// Up to four triangles. A lane without one has NaN for coordinates, which nothing hits, and
/// `no_prim`. The lanes in use come first.
struct alignas(64) TriangleBlock {
    static constexpr std::size_t width = 4;

    std::array<std::array<std::array<float, width>, 3>, 3>
        vertices; ///< by vertex, then axis, then lane
    std::array<PrimId, width> prims;
    std::array<float, width> doubled_extents; ///< see doubled_extent
    std::uint32_t is_last;                    ///< of its leaf: 1; 0 when the next block belongs too
    std::array<std::uint32_t, 3> unused;      ///< 0

    void set(std::size_t lane, const Triangle& triangle, PrimId prim);
    void clear(std::size_t lane);

    [[nodiscard]] Triangle triangle(std::size_t lane) const {
        const auto vertex = [&](std::size_t i) {
            return Vec3{vertices[i][0][lane], vertices[i][1][lane], vertices[i][2][lane]};
        };
        return {vertex(0), vertex(1), vertex(2)};
    }
};

static_assert(sizeof(TriangleBlock) == 192, "three cache lines; see WideRef");

/// At least twice the longest side of the triangle's box: how far a vertex may be, sheared along
/// any ray that hits the triangle, from that ray.
[[nodiscard]] float doubled_extent(const Triangle& triangle);

/// nodes[0] is the root; an empty tree has no nodes. Every slot's box encloses the part of its
/// triangles that it answers for; a triangle may stand in several leaves. No path is longer than
/// `max_depth` nodes.
struct WideBvh {
    static constexpr std::size_t max_depth = 65;

    LargeVector<WideNode> nodes;
    LargeVector<TriangleBlock> blocks;
    Aabb vertex_bounds; ///< of the triangles, in the world
    Aabb box;           ///< of all slots of the root, in the frame
    BoxFrame frame;     ///< of the boxes; triangles are in the world always

    [[nodiscard]] bool is_empty() const { return nodes.empty(); }

    [[nodiscard]] std::size_t size_in_bytes() const {
        return nodes.size() * sizeof(WideNode) + blocks.size() * sizeof(TriangleBlock);
    }
};

} // namespace raywise
