#include <raywise/bvh/refit.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>

#include <cstddef>
#include <span>

namespace raywise {

void refit(Bvh& tree, std::span<const Aabb> boxes) {
    // Children stand after their parent, so the reverse order meets them first.
    for (std::size_t i = tree.nodes.size(); i-- > 0;) {
        Node& node = tree.nodes[i];
        Aabb box;
        if (node.is_leaf()) {
            for (const PrimId prim : tree.prims_of(node))
                box = unite(box, boxes[to_index(prim)]);
        } else {
            box = unite(tree[node.left()].box(), tree[node.right()].box());
        }
        node.set_box(box);
    }
}

} // namespace raywise
