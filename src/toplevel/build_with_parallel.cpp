// The builders for parallel rays.
#include "build_with.inl.hpp" // IWYU pragma: keep

namespace raywise::detail {

template BuiltTree
build_with(const BuildInput&, const ParallelMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);

} // namespace raywise::detail
