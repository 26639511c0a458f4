// What a query tells of its work.
#pragma once

#include <raywise/pencil/pencil_grid_params.hpp>

#include <cstddef>

namespace raywise::pencil_detail {

/// Counts nothing, costs nothing.
struct NoCounts {
    static void query() {}
    static void cell() {}
    static void list(std::size_t) {}
    static void prim() {}
    static void decided() {}
};

struct Counts {
    PencilGridCounts* counts;

    void query() const { ++counts->queries; }
    void cell() const { ++counts->cells; }
    void list(std::size_t references) const {
        ++counts->lists;
        counts->references += references;
    }
    void prim() const { ++counts->prims; }
    void decided() const { ++counts->decided; }
};

} // namespace raywise::pencil_detail
