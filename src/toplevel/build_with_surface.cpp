// The builders for uniform lines.
#include "build_with.inl.hpp" // IWYU pragma: keep

namespace raywise::detail {

template BuiltTree
build_with(const BuildInput&, const SurfaceMeasure&, const ChosenAxes&, const Heuristic&, const Executor&);

} // namespace raywise::detail
