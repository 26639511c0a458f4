// How many bytes a structure holds, measured from its containers rather than from a formula.
#pragma once

#include <raywise/bvh/bvh.hpp>

#include <cstddef>

namespace raywise {

/// Bytes of elements in use, by what they are; spare capacity is not counted.
struct MemoryUse {
    std::size_t nodes = 0;
    std::size_t references = 0; ///< primitive ids in leaf order
    std::size_t triangles = 0;  ///< copies of triangle data; 0 when the caller's mesh is read
    std::size_t areas = 0;      ///< influence areas
    std::size_t index = 0;      ///< the region index

    [[nodiscard]] std::size_t total() const {
        return nodes + references + triangles + areas + index;
    }

    MemoryUse& operator+=(const MemoryUse& other);
};

/// Nodes and references of a tree. O(1).
[[nodiscard]] MemoryUse measure_memory(const Bvh& tree);

} // namespace raywise
