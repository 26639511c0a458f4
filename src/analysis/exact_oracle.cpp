#include <raywise/analysis/exact_oracle.hpp>

#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <optional>
#include <span>

namespace raywise {

ExactOracle::ExactOracle(const TriangleView& triangles, const Executor& executor)
    : tree_(build_tree(build_input_of(triangles, executor), surface_area_heuristic(), executor).tree
      )
    , triangles_(tree_, triangles) {}

std::optional<Hit> ExactOracle::closest_hit(const Ray& ray) const {
    return raywise::closest_hit(tree_, triangles_, ray);
}

bool ExactOracle::any_hit(const Ray& ray) const {
    return raywise::any_hit(tree_, triangles_, ray);
}

void ExactOracle::closest_hits(
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) const {
    raywise::closest_hits(tree_, triangles_, rays, hits, executor);
}

void ExactOracle::any_hits(
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) const {
    raywise::any_hits(tree_, triangles_, rays, occluded, executor);
}

} // namespace raywise
