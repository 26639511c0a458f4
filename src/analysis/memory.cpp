#include <raywise/analysis/memory.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/core/ids.hpp>

namespace raywise {

MemoryUse& MemoryUse::operator+=(const MemoryUse& other) {
    nodes += other.nodes;
    references += other.references;
    triangles += other.triangles;
    areas += other.areas;
    index += other.index;
    return *this;
}

MemoryUse measure_memory(const Bvh& tree) {
    return {
        .nodes = tree.nodes.size() * sizeof(Node), .references = tree.prims.size() * sizeof(PrimId)
    };
}

} // namespace raywise
