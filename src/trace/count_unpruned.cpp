#include <raywise/trace/count_unpruned.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/trace/observer.hpp>
#include <raywise/trace/traverse.hpp>

#include <limits>

namespace raywise {

Counts count_unpruned(const Bvh& tree, const Ray& ray) {
    Ray half_line = ray;
    half_line.t_min = 0;
    half_line.t_max = std::numeric_limits<float>::infinity();
    Counts counts;
    traverse(tree, half_line, counts, [&](const Node& leaf, float&) {
        counts.prims += leaf.count();
        return true;
    });
    return counts;
}

} // namespace raywise
