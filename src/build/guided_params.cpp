#include <raywise/build/guided_params.hpp>

#include <raywise/core/error.hpp>

#include <cmath>

namespace raywise {

void check(const GuidedParams& params) {
    const auto is_positive = [](double value) { return std::isfinite(value) && value > 0; };
    if (params.bin_count < 3 || params.bin_count > 4096)
        throw Error("bin_count must be in [3, 4096]");
    if (!(params.quality_threshold >= 0 && params.quality_threshold <= 1))
        throw Error("quality_threshold must be in [0, 1]");
    if (!(params.acceptable_ratio >= 0) || !(params.excellent_ratio >= 0))
        throw Error("ratios must not be negative");
    if (params.max_levels < 1) throw Error("max_levels must be at least 1");
    if (params.max_measured_levels < 0) throw Error("max_measured_levels must not be negative");
    if (!(params.max_leaf_cost >= 0) || !(params.max_leaf_probability >= 0) ||
        !(params.max_leaf_area >= 0))
        throw Error("leaf limits must not be negative");
    if (params.max_leaf_size < 1) throw Error("max_leaf_size must be at least 1");
    if (params.total_mass && !is_positive(*params.total_mass))
        throw Error("total_mass must be finite and positive");
    if (!is_positive(params.cost.node) || !is_positive(params.cost.prim))
        throw Error("costs must be finite and positive");
}

} // namespace raywise
