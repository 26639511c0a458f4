// Tree files: what comes back is what was saved, and nothing else is ever read.
#include <raywise/io/tree_file.hpp>

#include "refusals.hpp"
#include "scratch_folder.hpp"

#include <raywise/bvh/bvh.hpp>
#include <raywise/io/files.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace raywise {
namespace {

using testing::HasSubstr;
using testing_io::refusal_of;
using testing_io::ScratchFolder;

/// A complete tree over unit boxes in a row, one in each leaf; leaves is a power of two.
Bvh row_of_boxes(std::uint32_t leaves) {
    struct Range {
        std::uint32_t node, first, count;
    };

    Bvh tree;
    tree.nodes.resize(2 * leaves - 1);
    std::uint32_t next = 1;
    std::vector<Range> pending{{0, 0, leaves}};
    while (!pending.empty()) {
        const Range range = pending.back();
        pending.pop_back();
        const Aabb box{
            {static_cast<float>(range.first), 0, 0},
            {static_cast<float>(range.first + range.count), 1, 1}
        };
        if (range.count == 1) {
            tree.nodes[range.node] = Node::leaf(box, range.first, 1);
            continue;
        }
        tree.nodes[range.node] = Node::inner(box, to_node(next));
        const std::uint32_t half = range.count / 2;
        pending.push_back({next + 1, range.first + half, half});
        pending.push_back({next, range.first, half});
        next += 2;
    }
    for (std::uint32_t i = 0; i < leaves; ++i)
        tree.prims.push_back(to_prim(leaves - 1 - i));
    return tree;
}

class TreeFiles : public testing::Test {
protected:
    TreeFiles() { save_tree(path_, {row_of_boxes(128), 42, 128}); }

    std::string refusal(const std::string& bytes) {
        folder_.write("tree.rwtree", bytes);
        return refusal_of([&] { (void)load_tree(path_); }).value_or("accepted");
    }

    ScratchFolder folder_;
    std::filesystem::path path_ = folder_.path() / "tree.rwtree";
};

TEST_F(TreeFiles, ComeBackBitForBit) {
    const Bvh tree = row_of_boxes(128);
    const TreeFile back = load_tree(path_);
    EXPECT_EQ(back.scene_hash, 42U);
    EXPECT_EQ(back.prim_count, 128U);
    ASSERT_EQ(back.tree.nodes.size(), tree.nodes.size());
    EXPECT_EQ(
        std::memcmp(back.tree.nodes.data(), tree.nodes.data(), tree.nodes.size() * sizeof(Node)), 0
    );
    EXPECT_EQ(back.tree.prims, tree.prims);
    EXPECT_EQ(folder_.count(), 1U);
}

TEST_F(TreeFiles, HoldTheEmptyTree) {
    save_tree(path_, {});
    EXPECT_TRUE(load_tree(path_).tree.is_empty());
}

TEST_F(TreeFiles, RefuseToWriteWhatIsNoTree) {
    EXPECT_THROW(save_tree(path_, {row_of_boxes(2), 0, 1}), Error); // it holds primitive 1
    EXPECT_EQ(load_tree(path_).prim_count, 128U); // the file there before is untouched
}

TEST_F(TreeFiles, RefuseEveryFlippedBitOfAnEightKilobyteFile) {
    std::string bytes = read_file(path_);
    ASSERT_GE(bytes.size(), 8192U);
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ static_cast<char>(1U << bit % 8));
        ASSERT_NE(refusal(bytes), "accepted") << bit;
        bytes[bit / 8] = static_cast<char>(bytes[bit / 8] ^ static_cast<char>(1U << bit % 8));
    }
    EXPECT_EQ(refusal(bytes), "accepted");
}

TEST_F(TreeFiles, RefuseEveryTruncationAndWhatIsAppended) {
    const std::string bytes = read_file(path_);
    for (std::size_t size = 0; size < bytes.size(); ++size)
        ASSERT_NE(refusal(bytes.substr(0, size)), "accepted") << size;
    EXPECT_NE(refusal(bytes + '\0'), "accepted");
}

TEST_F(TreeFiles, SayWhatIsWrong) {
    std::string bytes = read_file(path_);
    EXPECT_THAT(refusal("solid"), HasSubstr("byte 0: not a tree file"));
    std::string newer = bytes;
    newer[8] = 2;
    EXPECT_THAT(refusal(newer), HasSubstr("byte 8: version 2 is not supported"));
    bytes[200] = static_cast<char>(bytes[200] + 1);
    EXPECT_THAT(refusal(bytes), HasSubstr("byte 128: the section's checksum is wrong"));
}

TEST_F(TreeFiles, SurviveMutations) {
    const std::string bytes = read_file(path_);
    EXPECT_EQ(
        testing_io::refused_mutations(
            bytes,
            3000,
            [&](const std::string& changed) {
                folder_.write("tree.rwtree", changed);
                (void)load_tree(path_);
                if (changed == bytes) throw Error("not changed at all");
            }
        ),
        3000U
    );
}

} // namespace
} // namespace raywise
