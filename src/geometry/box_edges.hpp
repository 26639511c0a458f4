// The edges and faces of a box by its vertex ids.
#pragma once

#include <array>
#include <cstddef>
#include <utility>

namespace raywise {

inline constexpr std::array<std::pair<std::size_t, std::size_t>, 12> box_edges{{
    {0, 1},
    {2, 3},
    {4, 5},
    {6, 7}, // along z
    {0, 2},
    {1, 3},
    {4, 6},
    {5, 7}, // along y
    {0, 4},
    {1, 5},
    {2, 6},
    {3, 7}, // along x
}};

/// Corners in order around the face that looks along each axis: on the low side, then the high.
inline constexpr std::array<std::array<std::array<std::size_t, 4>, 2>, 3> box_faces{{
    {{{0, 1, 3, 2}, {4, 6, 7, 5}}},
    {{{0, 4, 5, 1}, {2, 3, 7, 6}}},
    {{{0, 2, 6, 4}, {1, 5, 7, 3}}},
}};

} // namespace raywise
