#include <raywise/bvh/statistics.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/walk.hpp>
#include <raywise/core/ids.hpp>

#include <algorithm>
#include <cstddef>

namespace raywise {

TreeStatistics measure_tree(const Bvh& tree) {
    TreeStatistics result;
    std::size_t depth_sum = 0;
    walk(tree, [&](NodeId id, int level) {
        result.max_depth = std::max(result.max_depth, level);
        const Node& node = tree[id];
        if (!node.is_leaf()) return;
        ++result.leaves;
        result.references += node.count();
        result.largest_leaf = std::max(result.largest_leaf, node.count());
        ++result.leaf_sizes[node.count()];
        depth_sum += static_cast<std::size_t>(level);
    });
    result.nodes = tree.nodes.size();
    result.bytes = tree.nodes.size() * sizeof(Node) + tree.prims.size() * sizeof(PrimId);
    if (result.leaves > 0)
        result.mean_leaf_depth =
            static_cast<double>(depth_sum) / static_cast<double>(result.leaves);
    return result;
}

} // namespace raywise
