#include <raywise/analysis/end_point_overlap.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/cost_constants.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/function_ref.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/triangle.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace raywise {

namespace {

constexpr std::uint32_t no_parent = 0xFFFFFFFFU;

/// Where a primitive stands in the tree: its leaves, as ranges of one array.
struct Places {
    std::vector<std::uint32_t> parents;                      // by node
    std::vector<std::pair<std::uint32_t, std::uint32_t>> of; // (primitive, leaf), ascending

    explicit Places(const Bvh& tree) : parents(tree.nodes.size(), no_parent) {
        for (std::uint32_t i = 0; i < tree.nodes.size(); ++i) {
            const Node& node = tree.nodes[i];
            if (node.is_leaf()) {
                for (const PrimId prim : tree.prims_of(node)) {
                    of.emplace_back(static_cast<std::uint32_t>(prim), i);
                }
            } else {
                parents[to_index(node.left())] = i;
                parents[to_index(node.right())] = i;
            }
        }
        std::sort(of.begin(), of.end());
    }
};

/// The nodes above one primitive at a time. Marks are stamps, so that moving on costs only the
/// path.
class Ancestors {
public:
    explicit Ancestors(const Places& places) : places_(places), marks_(places.parents.size(), 0) {}

    void move_to(PrimId prim) {
        ++stamp_;
        const auto id = static_cast<std::uint32_t>(prim);
        auto place =
            std::lower_bound(places_.of.begin(), places_.of.end(), std::pair{id, std::uint32_t{0}});
        for (; place != places_.of.end() && place->first == id; ++place) {
            for (std::uint32_t node = place->second; node != no_parent;
                 node = places_.parents[node]) {
                marks_[node] = stamp_;
            }
        }
    }

    [[nodiscard]] bool contain(std::size_t node) const { return marks_[node] == stamp_; }

private:
    const Places& places_;
    std::vector<std::uint32_t> marks_;
    std::uint32_t stamp_ = 0;
};

double cost_of(const Node& node, const CostConstants& constants) {
    return node.is_leaf() ? constants.prim * static_cast<double>(node.count()) : 2 * constants.node;
}

/// Sum of cost times share over the nodes that do not own the primitive. `share_in(box)` is what of
/// it lies in a box, 0 for none; then nothing lies in the boxes below.
template <class ShareIn>
double cost_outside(
    const Bvh& tree,
    const Ancestors& owners,
    const CostConstants& constants,
    std::vector<std::uint32_t>& pending,
    ShareIn&& share_in
) {
    double cost = 0;
    pending.assign(1, 0);
    while (!pending.empty()) {
        const std::uint32_t id = pending.back();
        pending.pop_back();
        const Node& node = tree.nodes[id];
        const double share = share_in(node.box());
        if (!(share > 0)) continue;
        if (!owners.contain(id)) cost += cost_of(node, constants) * share;
        if (node.is_leaf()) continue;
        pending.push_back(static_cast<std::uint32_t>(node.left()));
        pending.push_back(static_cast<std::uint32_t>(node.right()));
    }
    return cost;
}

using Polygon = std::vector<Vec3d>;

/// Keeps the part of `in` with sign * (p[axis] - bound) <= 0.
void cut(const Polygon& in, int axis, double bound, double sign, Polygon& out) {
    out.clear();
    for (std::size_t i = 0; i < in.size(); ++i) {
        const Vec3d a = in[i];
        const Vec3d b = in[(i + 1) % in.size()];
        const double da = sign * (a[axis] - bound);
        const double db = sign * (b[axis] - bound);
        if (da <= 0) out.push_back(a);
        if ((da < 0 && db > 0) || (da > 0 && db < 0)) {
            Vec3d crossing = a + (b - a) * (da / (da - db));
            crossing[axis] = bound;
            out.push_back(crossing);
        }
    }
}

double area(const Polygon& polygon) {
    Vec3d sum;
    for (std::size_t i = 2; i < polygon.size(); ++i) {
        sum = sum + cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
    }
    return length(sum) / 2;
}

double area(const Triangle& triangle) {
    const Vec3d v0 = to_double(triangle.v0);
    return length(cross(to_double(triangle.v1) - v0, to_double(triangle.v2) - v0)) / 2;
}

/// Clips triangles to boxes; keeps its storage from one to the next.
class BoxClipper {
public:
    double area_inside(const Triangle& triangle, const Aabb& box) {
        const Aabb own = bounds(triangle);
        if (!overlaps(own, box)) return 0;
        if (contains(box, own)) return area(triangle);
        now_.assign({to_double(triangle.v0), to_double(triangle.v1), to_double(triangle.v2)});
        for (int axis = 0; axis < 3; ++axis) {
            cut(now_, axis, static_cast<double>(box.lo[axis]), -1, next_);
            cut(next_, axis, static_cast<double>(box.hi[axis]), 1, now_);
        }
        return area(now_);
    }

private:
    Polygon now_;
    Polygon next_;
};

/// Chunks large enough that the marks of a chunk cost less than its work; the same for any number
/// of threads, as the sums must be.
std::size_t chunk_for(std::size_t count) {
    return std::max<std::size_t>(1024, (count + 63) / 64);
}

double sum_of_chunks(
    std::size_t count,
    const Executor& executor,
    FunctionRef<double(std::size_t, std::size_t)> work
) {
    const std::size_t chunk = chunk_for(count);
    std::vector<double> sums((count + chunk - 1) / chunk, 0);
    executor.for_each_chunk(count, chunk, [&](std::size_t begin, std::size_t end) {
        sums[begin / chunk] = work(begin, end);
    });
    double sum = 0;
    for (const double part : sums)
        sum += part;
    return sum;
}

std::vector<PrimId> distinct_prims(const Bvh& tree) {
    std::vector<PrimId> prims = tree.prims;
    std::sort(prims.begin(), prims.end());
    prims.erase(std::unique(prims.begin(), prims.end()), prims.end());
    return prims;
}

/// At most `most` of the ids, evenly spread.
std::vector<PrimId> every_kth(const std::vector<PrimId>& all, std::size_t most) {
    const std::size_t step = all.size() / most + (all.size() % most != 0 ? 1 : 0);
    std::vector<PrimId> chosen;
    for (std::size_t i = 0; i < all.size(); i += step)
        chosen.push_back(all[i]);
    return chosen;
}

} // namespace

double measure_end_point_overlap(
    const Bvh& tree,
    const TriangleView& triangles,
    const CostConstants& constants,
    const Executor& executor,
    std::size_t most_triangles
) {
    if (tree.is_empty()) return 0;
    const Places places(tree);
    const std::vector<PrimId> prims = every_kth(distinct_prims(tree), most_triangles);
    double surface = 0;
    for (const PrimId prim : prims)
        surface += area(triangles[prim]);
    if (!(surface > 0)) return 0;
    const double cost =
        sum_of_chunks(prims.size(), executor, [&](std::size_t begin, std::size_t end) {
            Ancestors owners(places);
            BoxClipper clipper;
            std::vector<std::uint32_t> pending;
            double sum = 0;
            for (std::size_t i = begin; i < end; ++i) {
                const Triangle triangle = triangles[prims[i]];
                owners.move_to(prims[i]);
                sum += cost_outside(tree, owners, constants, pending, [&](const Aabb& box) {
                    return clipper.area_inside(triangle, box);
                });
            }
            return sum;
        });
    return cost / surface;
}

double measure_end_point_overlap(
    const Bvh& tree,
    std::span<const EndPoint> points,
    const CostConstants& constants,
    const Executor& executor
) {
    if (tree.is_empty() || points.empty()) return 0;
    const Places places(tree);
    const double cost =
        sum_of_chunks(points.size(), executor, [&](std::size_t begin, std::size_t end) {
            Ancestors owners(places);
            std::vector<std::uint32_t> pending;
            double sum = 0;
            for (const EndPoint& end_point : points.subspan(begin, end - begin)) {
                const Aabb spot{end_point.point, end_point.point};
                owners.move_to(end_point.prim);
                sum += cost_outside(tree, owners, constants, pending, [&](const Aabb& box) {
                    return overlaps(box, spot) ? 1.0 : 0.0;
                });
            }
            return sum;
        });
    return cost / static_cast<double>(points.size());
}

} // namespace raywise
