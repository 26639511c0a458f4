#include <raywise/optimize/child_order.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/optimize/depth_first.hpp>

#include <algorithm>
#include <utility>

namespace raywise {

Bvh order_front_to_back(Bvh tree, Vec3d direction) {
    const auto depth = [&](const Aabb& box) {
        return dot(to_double(box.lo) + to_double(box.hi), direction);
    };
    for (const Node& node : tree.nodes) {
        if (node.is_leaf()) continue;
        Node& left = tree.nodes[to_index(node.left())];
        Node& right = tree.nodes[to_index(node.right())];
        // Contents may change places: what they link to does not.
        if (depth(right.box()) < depth(left.box())) std::swap(left, right);
    }
    return depth_first(tree);
}

double box_coverage(const Triangle& triangle) {
    const Vec3d v0 = to_double(triangle.v0);
    const double area =
        0.5 * length(cross(to_double(triangle.v1) - v0, to_double(triangle.v2) - v0));
    const Aabb box = bounds(triangle);
    const Vec3d s = to_double(box.hi) - to_double(box.lo);
    const double half_surface = s.x * s.y + s.y * s.z + s.z * s.x;
    return half_surface > 0 ? std::min(1.0, area / half_surface) : 0.0;
}

NodeOutlook outlook_in_order(
    const NodeOutlook& left,
    double left_share,
    const NodeOutlook& right,
    double right_share,
    const CostConstants& cost
) {
    const double through = 1 - left_share * left.opacity;
    return {
        2 * cost.node + left_share * left.cost + through * right_share * right.cost,
        1 - through * (1 - right_share * right.opacity)
    };
}

} // namespace raywise
