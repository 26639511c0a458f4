// The builders for radial rays with a grain of uniform lines.
#include "build_with.inl.hpp" // IWYU pragma: keep

namespace raywise::detail {

template BuiltTree
build_with(const BuildInput&, const MixedMeasure<RadialMeasure>&, const ChosenAxes&, const Heuristic&, const Executor&);

} // namespace raywise::detail
