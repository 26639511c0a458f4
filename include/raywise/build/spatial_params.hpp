// Parameters of the builder with spatial splits.
#pragma once

#include <raywise/build/binned_params.hpp>

#include <cstddef>

namespace raywise {

/// Parameters of build_spatial.
struct SpatialParams {
    BinnedParams binned{};       ///< of object splits, leaves, depth and costs
    int spatial_bins = 16;       ///< most parts per axis that triangles are cut into, in [2, 64]
    double duplication = 0.3;    ///< most further references per triangle, in [0, 8]; 0: no cut
    double least_overlap = 1e-5; ///< cuts are tried where the children of the best object split
                                 ///< share more than this part of the root's mass; >= 0
};

/// Nodes of at most so many references are not cut: it changes the tree by less than a thousandth.
inline constexpr std::size_t few_references = 8;

/// Nor are nodes of fewer than `small_node` references where the halves of the best object split
/// share less than this part of the side that it divides: it nearly halves the time of a build and
/// changes traced costs by less than a hundredth.
inline constexpr std::size_t small_node = 1024;
inline constexpr float thin_slice = 0.1F;

/// Throws Error when a parameter is out of its range.
void check(const SpatialParams& params);

} // namespace raywise
