#include <raywise/toplevel/traced_tree.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/ids.hpp>

#include <cstddef>

namespace raywise {

std::size_t TracedTree::size_in_bytes() const {
    if (const WideBvh* tree = wide()) return tree->size_in_bytes();
    const Bvh& tree = binary()->tree;
    return tree.nodes.capacity() * sizeof(Node) + tree.prims.capacity() * sizeof(PrimId) +
           binary()->triangles.size_in_bytes();
}

} // namespace raywise
