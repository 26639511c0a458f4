#include <raywise/bvh/validate.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace raywise {
namespace {

using ::testing::HasSubstr;

Aabb span_x(float lo, float hi) {
    return {{lo, 0, 0}, {hi, 1, 1}};
}

/// A root over two leaves: primitives 2 and 0, and primitive 1.
Bvh small_tree() {
    return {
        {Node::inner(span_x(0, 4), NodeId{1}),
         Node::leaf(span_x(0, 2), 0, 2),
         Node::leaf(span_x(3, 4), 2, 1)},
        {PrimId{2}, PrimId{0}, PrimId{1}}
    };
}

const std::vector<Aabb> small_boxes{span_x(1, 2), span_x(3, 4), span_x(0, 1)};

std::string fault_of(const Bvh& tree) {
    return find_fault(tree, small_boxes).value_or("none");
}

/// A node with arbitrary link and count, as a file may hold it.
Node forged(const Aabb& box, std::uint32_t first, std::uint32_t count) {
    const std::array<std::uint32_t, 2> link{first, count};
    Node node;
    node.set_box(box);
    std::memcpy(reinterpret_cast<std::byte*>(&node) + sizeof(Aabb), link.data(), sizeof link);
    return node;
}

TEST(Validate, AcceptsAValidTreeAndTheEmptyOne) {
    EXPECT_EQ(fault_of(small_tree()), "none");
    EXPECT_EQ(fault_of(Bvh{}), "none");
    EXPECT_NO_THROW(validate(small_tree(), small_boxes));
    EXPECT_NO_THROW(validate(small_tree(), std::size_t{3}));
}

TEST(Validate, ThrowsTheReason) {
    Bvh tree = small_tree();
    tree.prims[1] = PrimId{3};
    try {
        validate(tree, std::size_t{3});
        FAIL() << "no error";
    } catch (const Error& error) {
        EXPECT_STREQ(
            error.what(), "not a valid tree: node 1 holds a primitive that does not exist"
        );
    }
}

TEST(Validate, RefusesPrimitivesWithoutNodes) {
    EXPECT_THAT(fault_of({{}, {PrimId{0}}}), HasSubstr("without nodes"));
}

TEST(Validate, RefusesChildrenOutsideTheTree) {
    Bvh tree = small_tree();
    for (const std::uint32_t left : {2U, 3U, 1000U, 0xFFFFFFFFU, 0xFFFFFFFEU}) {
        tree.nodes[0] = forged(span_x(0, 4), left, 0);
        EXPECT_THAT(fault_of(tree), HasSubstr("node 0 has a child outside the tree")) << left;
    }
}

TEST(Validate, RefusesCycles) {
    Bvh tree = small_tree();
    tree.nodes[0] = forged(span_x(0, 4), 0, 0);
    EXPECT_THAT(fault_of(tree), HasSubstr("stands before it"));
    tree = small_tree();
    tree.nodes[2] = forged(span_x(3, 4), 1, 0);
    EXPECT_THAT(fault_of(tree), HasSubstr("stands before it"));
}

TEST(Validate, RefusesSharedAndUnreachedNodes) {
    Bvh tree = small_tree();
    tree.nodes.push_back(Node::leaf(span_x(3, 4), 2, 1));
    EXPECT_THAT(fault_of(tree), HasSubstr("node 3 is not reached"));
    // Nodes 1 and 2 both claim 3 and 4.
    tree.nodes[1] = Node::inner(span_x(0, 2), NodeId{3});
    tree.nodes[2] = Node::inner(span_x(3, 4), NodeId{3});
    tree.nodes[3] = Node::leaf(span_x(1, 2), 0, 2);
    tree.nodes.push_back(Node::leaf(span_x(1, 2), 2, 1));
    EXPECT_THAT(fault_of(tree), HasSubstr("node 2 shares a child"));
}

TEST(Validate, RefusesSlotsOutsideSharedOrUncovered) {
    Bvh tree = small_tree();
    tree.nodes[2] = Node::leaf(span_x(3, 4), 2, 2);
    EXPECT_THAT(fault_of(tree), HasSubstr("slot outside"));
    tree.nodes[2] = forged(span_x(3, 4), 0xFFFFFFFFU, 0xFFFFFFFFU);
    EXPECT_THAT(fault_of(tree), HasSubstr("slot outside"));
    tree.nodes[2] = Node::leaf(span_x(0, 4), 1, 2);
    tree.nodes[0] = Node::inner(span_x(0, 4), NodeId{1});
    EXPECT_THAT(fault_of(tree), HasSubstr("shares a primitive slot"));
    tree = small_tree();
    tree.prims.push_back(PrimId{0});
    EXPECT_THAT(fault_of(tree), HasSubstr("belongs to no leaf"));
}

TEST(Validate, RefusesBoxesThatDoNotEnclose) {
    Bvh tree = small_tree();
    tree.nodes[0].set_box(span_x(0, 3.5F));
    EXPECT_THAT(fault_of(tree), HasSubstr("does not enclose its children"));
    tree = small_tree();
    tree.nodes[1].set_box(span_x(0.5F, 2));
    EXPECT_THAT(fault_of(tree), HasSubstr("does not enclose its primitives"));
    EXPECT_EQ(find_fault(tree, std::size_t{3}), std::nullopt); // the boxes are not known
}

TEST(Validate, RefusesBoxesWithNanInfinityOrNothing) {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    constexpr float infinity = std::numeric_limits<float>::infinity();
    for (const Aabb& bad :
         {Aabb{}, span_x(nan, 4), span_x(0, nan), span_x(0, infinity), span_x(4, 0)}) {
        for (std::size_t id = 0; id < 3; ++id) {
            Bvh tree = small_tree();
            tree.nodes[id].set_box(bad);
            EXPECT_NE(fault_of(tree), "none");
        }
        std::vector<Aabb> boxes = small_boxes;
        boxes[0] = bad;
        EXPECT_TRUE(find_fault(small_tree(), boxes));
    }
}

/// A chain whose deepest leaves have level `depth`.
Bvh chain(int depth) {
    Bvh tree;
    tree.nodes.push_back(Node::leaf(span_x(0, 1), 0, 1));
    tree.prims.push_back(PrimId{0});
    std::uint32_t open = 0;
    for (int level = 1; level <= depth; ++level) {
        const auto pair = static_cast<std::uint32_t>(tree.nodes.size());
        tree.nodes.push_back(Node::leaf(span_x(0, 1), tree.nodes[open].first() & 0xFFFFFFFFU, 1));
        tree.nodes.push_back(
            Node::leaf(span_x(0, 1), static_cast<std::uint32_t>(tree.prims.size()), 1)
        );
        tree.nodes[open] = Node::inner(span_x(0, 1), NodeId{pair});
        tree.prims.push_back(PrimId{0});
        open = pair + 1;
    }
    return tree;
}

TEST(Validate, RefusesTreesDeeperThanAllowed) {
    EXPECT_EQ(find_fault(chain(Bvh::max_depth), std::size_t{1}), std::nullopt);
    EXPECT_THAT(
        find_fault(chain(Bvh::max_depth + 1), std::size_t{1}).value_or("none"), HasSubstr("deeper")
    );
}

TEST(Validate, SurvivesArbitraryBytes) {
    for (std::uint64_t seed = 0; seed < 20'000; ++seed) {
        Rng rng(seed);
        Bvh tree;
        tree.nodes.resize(rng.below(9));
        tree.prims.resize(rng.below(9));
        for (Node& node : tree.nodes)
            node = forged(
                rng.below(4) > 0 ? span_x(0, 1) : Aabb{},
                static_cast<std::uint32_t>(rng.below(12)),
                static_cast<std::uint32_t>(rng.below(3))
            );
        for (PrimId& prim : tree.prims)
            prim = to_prim(rng.below(5));
        if (!find_fault(tree, std::size_t{4})) {
            // What passes must be safe to walk: a full binary tree that covers its slots.
            std::size_t slots = 0;
            for (const Node& node : tree.nodes)
                slots += node.is_leaf() ? node.count() : 0;
            EXPECT_EQ(slots, tree.prims.size());
            EXPECT_TRUE(tree.nodes.empty() || tree.nodes.size() % 2 == 1);
        }
    }
}

} // namespace
} // namespace raywise
