#include <raywise/optimize/reinsertion.hpp>

#include <raywise/core/error.hpp>

namespace raywise {

void check(const ReinsertionParams& params) {
    if (!(params.batch > 0 && params.batch <= 1)) throw Error("batch must be in (0, 1]");
    if (!(params.least_gain >= 0)) throw Error("least_gain must not be negative");
    if (params.max_rounds < 0 || params.max_rounds > 1000)
        throw Error("max_rounds must be in [0, 1000]");
}

} // namespace raywise
