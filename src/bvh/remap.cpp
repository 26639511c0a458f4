#include <raywise/bvh/remap.hpp>

#include <raywise/core/error.hpp>

#include <algorithm>

namespace raywise {

void remap_prims(Bvh& tree, std::span<const PrimId> ids) {
    const auto is_known = [&](PrimId prim) { return to_index(prim) < ids.size(); };
    if (!std::all_of(tree.prims.begin(), tree.prims.end(), is_known))
        throw Error("the tree holds a primitive that the list of ids does not name");
    for (PrimId& prim : tree.prims)
        prim = ids[to_index(prim)];
}

} // namespace raywise
