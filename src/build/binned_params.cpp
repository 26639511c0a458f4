#include <raywise/build/binned_params.hpp>

#include <raywise/build/bins.hpp>
#include <raywise/bvh/bvh.hpp>
#include <raywise/core/error.hpp>

#include <cmath>

namespace raywise {

void check(const BinnedParams& params) {
    const auto is_cost = [](double value) { return std::isfinite(value) && value > 0; };
    if (params.bin_count < 2 || params.bin_count > BinGrid::most)
        throw Error("bin_count must be in [2, 256]");
    if (params.max_leaf_size < 1) throw Error("max_leaf_size must be at least 1");
    if (params.max_depth < 1 || params.max_depth > Bvh::max_depth)
        throw Error("max_depth must be in [1, 64]");
    if (!is_cost(params.cost.node) || !is_cost(params.cost.prim))
        throw Error("costs must be finite and positive");
}

} // namespace raywise
