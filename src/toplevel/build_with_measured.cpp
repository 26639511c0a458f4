// The builders for counted rays.
#include "build_with.inl.hpp" // IWYU pragma: keep

namespace raywise::detail {

template BuiltTree
build_with(const BuildInput&, const MeasuredMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);

} // namespace raywise::detail
