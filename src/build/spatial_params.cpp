#include <raywise/build/spatial_params.hpp>

#include <raywise/build/binned_params.hpp>
#include <raywise/build/spatial_bins.hpp>
#include <raywise/core/error.hpp>

namespace raywise {

void check(const SpatialParams& params) {
    check(params.binned);
    if (params.spatial_bins < 2 || params.spatial_bins > SpatialGrid::most)
        throw Error("spatial_bins must be in [2, 64]");
    if (!(params.duplication >= 0 && params.duplication <= 8))
        throw Error("duplication must be in [0, 8]");
    if (!(params.least_overlap >= 0)) throw Error("least_overlap must not be negative");
}

} // namespace raywise
