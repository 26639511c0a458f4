#include <raywise/bvh/remap.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/ids.hpp>

#include <span>

namespace raywise {
namespace {

/// Looks before it renames. `for_each_prim(visit)` visits every primitive.
template <class ForEachPrim>
void remap(std::span<const PrimId> ids, const ForEachPrim& for_each_prim) {
    for_each_prim([&](const PrimId& prim) {
        if (to_index(prim) >= ids.size())
            throw Error("the tree holds a primitive that the list of ids does not name");
    });
    for_each_prim([&](PrimId& prim) { prim = ids[to_index(prim)]; });
}

} // namespace

void remap_prims(Bvh& tree, std::span<const PrimId> ids) {
    remap(ids, [&](const auto& visit) {
        for (PrimId& prim : tree.prims)
            visit(prim);
    });
}

void remap_prims(WideBvh& tree, std::span<const PrimId> ids) {
    remap(ids, [&](const auto& visit) {
        for (TriangleBlock& block : tree.blocks) {
            for (PrimId& prim : block.prims)
                if (prim != no_prim) visit(prim);
        }
    });
}

} // namespace raywise
