// The builders for counted rays with a grain of uniform lines.
#include "build_with.inl.hpp" // IWYU pragma: keep

namespace raywise::detail {

template BuiltTree
build_with(const BuildInput&, const MixedMeasure<MeasuredMeasure>&, const ChosenAxes&, const Heuristic&, const Executor&);

} // namespace raywise::detail
