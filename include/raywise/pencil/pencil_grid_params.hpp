// Parameters of the pencil grid, and what a finished one is like.
#pragma once

#include <raywise/core/ids.hpp>

#include <cstddef>
#include <cstdint>

namespace raywise {

/// Parameters of build_pencil_grid.
struct PencilGridParams {
    /// References that a cell of the uniform top grid should have on average, in [1, 256]. Fewer,
    /// longer lists cost less memory and time to build; a query looks at 32 of them at once.
    double cell_size = 16;

    /// A cell with more references is cut into 4 x 4, while that pays, in [4, 4096].
    std::uint32_t leaf_size = 128;

    /// The cap on size_in_bytes() is this times the triangles, plus 64 KiB; >= 64. The build keeps
    /// it by taking coarser cells.
    double bytes_per_triangle = 100;
};

/// Throws Error when a parameter is out of its range.
void check(const PencilGridParams& params);

/// What a grid is made of.
struct PencilGridStatistics {
    std::size_t faces = 0;      ///< cube faces with geometry; 1 or 0 for a parallel pencil
    std::size_t top_cells = 0;  ///< of the uniform grids
    std::size_t leaves = 0;     ///< cells with a list
    std::size_t empty = 0;      ///< cells without
    std::size_t splits = 0;     ///< cells cut into 4 x 4
    std::size_t references = 0; ///< in all lists
    std::size_t culled = 0;     ///< references dropped because two triangles hide them
    std::size_t near = 0;       ///< triangles at the apex, which every query looks at
    std::size_t coarsened = 0;  ///< how often the build began anew to keep the cap
};

/// Counts what queries do.
struct PencilGridCounts {
    std::uint64_t queries = 0;
    std::uint64_t cells = 0;      ///< looked up, subcells included
    std::uint64_t lists = 0;      ///< opened
    std::uint64_t references = 0; ///< compared with the query's place
    std::uint64_t prims = 0;      ///< triangle tests
    std::uint64_t decided = 0;    ///< triangle tests that went on to exact arithmetic

    friend bool operator==(const PencilGridCounts&, const PencilGridCounts&) = default;

    PencilGridCounts& operator+=(const PencilGridCounts& other) {
        queries += other.queries;
        cells += other.cells;
        lists += other.lists;
        references += other.references;
        prims += other.prims;
        decided += other.decided;
        return *this;
    }
};

} // namespace raywise
