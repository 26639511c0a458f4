#include <raywise/analysis/overlap.hpp>

#include <raywise/bvh/bvh.hpp>
#include <raywise/bvh/walk.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/distribution/ray_distribution.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/ray_box.hpp>

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <variant>
#include <vector>

namespace raywise {

void SiblingOverlap::add(int level, const PairMass& mass) {
    assert(level >= 0);
    const auto index = static_cast<std::size_t>(level);
    if (index >= sums_.size()) sums_.resize(index + 1);
    const double smaller = std::min(mass.left, mass.right);
    if (!(smaller > 0)) return;
    sums_[index].shared += mass.shared;
    sums_[index].smaller += smaller;
}

SiblingOverlap& SiblingOverlap::operator+=(const SiblingOverlap& other) {
    if (other.sums_.size() > sums_.size()) sums_.resize(other.sums_.size());
    for (std::size_t i = 0; i < other.sums_.size(); ++i) {
        sums_[i].shared += other.sums_[i].shared;
        sums_[i].smaller += other.sums_[i].smaller;
    }
    return *this;
}

double SiblingOverlap::at(int level) const {
    if (level < 0 || level >= levels()) return 0;
    const Sums& sums = sums_[static_cast<std::size_t>(level)];
    return sums.smaller > 0 ? sums.shared / sums.smaller : 0;
}

double SiblingOverlap::up_to(int level) const {
    Sums total;
    for (int i = 0; i <= std::min(level, levels() - 1); ++i) {
        total.shared += sums_[static_cast<std::size_t>(i)].shared;
        total.smaller += sums_[static_cast<std::size_t>(i)].smaller;
    }
    return total.smaller > 0 ? total.shared / total.smaller : 0;
}

namespace {

PairMass pair_mass(const ParallelMeasure& measure, Culling culling, const Aabb& a, const Aabb& b) {
    if (culling == Culling::unculled) {
        return {measure.unculled(a), measure.unculled(b), measure.unculled_shared(a, b)};
    }
    return {static_cast<double>(measure(a)), static_cast<double>(measure(b)), measure.shared(a, b)};
}

PairMass pair_mass(const RadialMeasure& measure, Culling culling, const Aabb& a, const Aabb& b) {
    if (culling == Culling::unculled) {
        const std::optional<double> shared = measure.unculled_shared(a, b);
        if (!shared) return {};
        return {measure.unculled(a), measure.unculled(b), *shared};
    }
    return {
        static_cast<double>(measure(a)),
        static_cast<double>(measure(b)),
        measure.shared(a, b).value_or(0)
    };
}

template <class M>
SiblingOverlap measure_overlap_by(const Bvh& tree, const M& measure, Culling culling) {
    return measure_overlap(tree, [&](const Aabb& left, const Aabb& right) {
        return pair_mass(measure, culling, left, right);
    });
}

} // namespace

std::optional<SiblingOverlap> measure_overlap(
    const Bvh& tree,
    const Distribution& distribution,
    Culling culling,
    MeasureMode mode
) {
    if (const auto* parallel = std::get_if<ParallelDistribution>(&distribution)) {
        return measure_overlap_by(tree, parallel->measure(), culling);
    }
    const auto* radial = std::get_if<RadialDistribution>(&distribution);
    if (radial == nullptr) return std::nullopt;
    RadialParams params = radial->params();
    const bool is_area = params.emission == Emission::pinhole || mode == MeasureMode::thesis;
    if (!params.window || params.radius > 0 || !is_area) return std::nullopt;
    params.emission = Emission::pinhole;
    return measure_overlap_by(tree, RadialMeasure(params, mode), culling);
}

namespace {

/// How many rays met the left child, the right child, and both, by inner node.
struct Meetings {
    std::vector<std::array<std::uint32_t, 3>> of_node;
};

void count_meetings(const Bvh& tree, const Ray& ray, Meetings& meetings) {
    std::array<NodeId, Bvh::max_depth + 1> pending{};
    std::size_t count = 0;
    if (!is_valid(ray) || !intersect(ray, tree.root().box())) return;
    pending[count++] = NodeId{0};
    while (count > 0) {
        const NodeId id = pending[--count];
        const Node& node = tree[id];
        if (node.is_leaf()) continue;
        const bool left = intersect(ray, tree[node.left()].box()).has_value();
        const bool right = intersect(ray, tree[node.right()].box()).has_value();
        auto& counts = meetings.of_node[to_index(id)];
        counts[0] += left ? 1U : 0U;
        counts[1] += right ? 1U : 0U;
        counts[2] += left && right ? 1U : 0U;
        if (right) pending[count++] = node.right();
        if (left) pending[count++] = node.left();
    }
}

} // namespace

SiblingOverlap
measure_overlap(const Bvh& tree, std::span<const Ray> rays, const Executor& executor) {
    if (tree.is_empty() || rays.empty()) return {};
    // Whole counts add up alike in any order, so chunks may be merged as they end.
    const std::size_t chunk = std::max<std::size_t>(4096, (rays.size() + 15) / 16);
    std::vector<Meetings> parts((rays.size() + chunk - 1) / chunk);
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        Meetings& part = parts[begin / chunk];
        part.of_node.resize(tree.nodes.size());
        for (const Ray& ray : rays.subspan(begin, end - begin))
            count_meetings(tree, ray, part);
    });
    std::vector<PairMass> masses(tree.nodes.size());
    for (const Meetings& part : parts) {
        for (std::size_t i = 0; i < masses.size(); ++i) {
            masses[i].left += part.of_node[i][0];
            masses[i].right += part.of_node[i][1];
            masses[i].shared += part.of_node[i][2];
        }
    }
    SiblingOverlap overlap;
    walk(tree, [&](NodeId id, int level) {
        if (!tree[id].is_leaf()) overlap.add(level, masses[to_index(id)]);
    });
    return overlap;
}

} // namespace raywise
