#include <raywise/toplevel/accelerator.hpp>

#include "toplevel/batches.hpp"

#include <raywise/bvh/wide_bvh.hpp>
#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/region.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/toplevel/area_id.hpp>
#include <raywise/toplevel/region_index.hpp>
#include <raywise/toplevel/served.hpp>
#include <raywise/trace/wide.hpp>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace raywise {
namespace {

std::size_t index_of(AreaId id) {
    return static_cast<std::size_t>(id);
}

} // namespace

float Accelerator::proven_end(AreaId area, const Ray& ray) const {
    if (local(area).is_whole) return std::numeric_limits<float>::infinity();
    const float exit = exit_parameter(areas_[index_of(area)].region, ray);
    // A hit's t was rounded: relative to a normal number that is within the margin of membership,
    // below the normal numbers, or from infinity, it might not be.
    if (!(exit >= std::numeric_limits<float>::min())) return 0;
    return std::min(exit, std::numeric_limits<float>::max());
}

bool Accelerator::is_cheaper(const Candidate& a, const Candidate& b) const {
    const double cost_a = local(a.area).expected_cost;
    const double cost_b = local(b.area).expected_cost;
    return cost_a != cost_b ? cost_a < cost_b : a.area < b.area;
}

bool Accelerator::is_better(const Candidate& a, const Candidate& b, float t_max) const {
    if (params_.mode == QueryMode::first_hit_wins) return a.area < b.area;
    const float reach_a = std::min(a.exit, t_max);
    const float reach_b = std::min(b.exit, t_max);
    if (reach_a != reach_b) return reach_a > reach_b;
    return is_cheaper(a, b);
}

Accelerator::Candidates Accelerator::candidates_of(const Ray& ray) const {
    const bool is_exact_mode = params_.mode == QueryMode::exact;
    const std::size_t limit =
        is_exact_mode ? static_cast<std::size_t>(params_.max_candidates) : most_candidates;
    Candidates best;
    if (!any_tree_) return best;
    visit_areas_at(index_, ray.origin, [&](AreaId id) {
        if (!local(id).has_tree || !follows(areas_[index_of(id)], ray)) return;
        const Candidate candidate{id, proven_end(id, ray)};
        if (is_exact_mode && candidate.exit <= ray.t_min) return;
        // Insertion into a short sorted list, whose last falls off when it is full.
        std::size_t at = std::min(best.count, limit - 1);
        if (best.count == limit && !is_better(candidate, best.items[at], ray.t_max)) return;
        for (; at > 0 && is_better(candidate, best.items[at - 1], ray.t_max); --at) {
            best.items[at] = best.items[at - 1];
        }
        best.items[at] = candidate;
        best.count = std::min(best.count + 1, limit);
    });
    if (!is_exact_mode) return best;
    // The cheapest first: the later ones only extend what it proves.
    for (std::size_t i = 1; i < best.count; ++i) {
        for (std::size_t k = i; k > 0 && is_cheaper(best.items[k], best.items[k - 1]); --k) {
            std::swap(best.items[k], best.items[k - 1]);
        }
    }
    return best;
}

Accelerator::Candidates Accelerator::candidates_in(AreaId area, const Ray& ray) const {
    Candidates only;
    if (!local(area).has_tree) return only;
    const bool is_served =
        local(area).is_whole || contains(areas_[index_of(area)].region, to_double(ray.origin));
    if (!is_served) return only;
    only.items[only.count++] = {area, proven_end(area, ray)};
    return only;
}

std::optional<Hit> Accelerator::closest_hit(const Ray& ray) const {
    // Most rays of most scenes: nothing stands between them and the tree, not even a copy.
    const WideBvh* everything = global_tree_.wide();
    if (everything != nullptr && is_of_no_area(ray))
        return raywise::closest_hit(*everything, ray, params_.trace_mode);
    SilentQuery nobody;
    return closest_hit(ray, nobody);
}

bool Accelerator::any_hit(const Ray& ray) const {
    const WideBvh* everything = global_tree_.wide();
    if (everything != nullptr && is_of_no_area(ray))
        return raywise::any_hit(*everything, ray, params_.trace_mode);
    SilentQuery nobody;
    return any_hit(ray, nobody);
}

const WideBvh* Accelerator::tree_of(std::span<const Ray> rays) const {
    const WideBvh* everything = global_tree_.wide();
    const auto is_its = [&](const Ray& ray) { return is_of_no_area(ray); };
    return everything != nullptr && std::all_of(rays.begin(), rays.end(), is_its) ? everything
                                                                                  : nullptr;
}

void Accelerator::closest_hits(
    std::span<const Ray> rays,
    std::span<Hit> hits,
    const Executor& executor
) const {
    detail::check_answers(rays.size(), hits.size());
    const auto answer = [&](const Ray& ray) { return closest_hit(ray).value_or(Hit{}); };
    const auto work = [&](std::span<const Ray> part, std::span<Hit> answers) {
        if (const WideBvh* tree = tree_of(part))
            raywise::closest_hits(*tree, part, answers, serial_executor(), params_.trace_mode);
        else
            std::transform(part.begin(), part.end(), answers.begin(), answer);
    };
    detail::for_each_part(rays, hits, executor, work);
}

void Accelerator::any_hits(
    std::span<const Ray> rays,
    std::span<bool> occluded,
    const Executor& executor
) const {
    detail::check_answers(rays.size(), occluded.size());
    const auto answer = [&](const Ray& ray) { return any_hit(ray); };
    const auto work = [&](std::span<const Ray> part, std::span<bool> answers) {
        if (const WideBvh* tree = tree_of(part))
            raywise::any_hits(*tree, part, answers, serial_executor(), params_.trace_mode);
        else
            std::transform(part.begin(), part.end(), answers.begin(), answer);
    };
    detail::for_each_part(rays, occluded, executor, work);
}

Accelerator Accelerator::with_trace_mode(TraceMode mode) const {
    Accelerator other = *this;
    other.params_.trace_mode = mode;
    return other;
}

AreaHandle Accelerator::operator[](std::string_view name) const {
    for (std::size_t i = 0; i < areas_.size(); ++i) {
        if (areas_[i].name == name) return {*this, to_area(i)};
    }
    throw Error("accelerator: no influence area is named '" + std::string(name) + "'");
}

AreaHandle Accelerator::operator[](AreaId id) const {
    if (index_of(id) >= areas_.size()) throw Error("accelerator: no such influence area");
    return {*this, id};
}

AcceleratorMemory Accelerator::measure_memory() const {
    AcceleratorMemory memory;
    memory.global_tree = global_tree_.size_in_bytes();
    std::size_t copy = 0;
    for (const LocalStructure& structure : locals_) {
        memory.local_trees += structure.tree.size_in_bytes();
        if (structure.grid) memory.grids += structure.grid->size_in_bytes();
        if (structure.triangles) copy = structure.triangles->size_in_bytes();
    }
    memory.grids += copy;
    memory.areas =
        areas_.capacity() * sizeof(InfluenceArea) + locals_.capacity() * sizeof(LocalStructure);
    memory.index = bytes(index_);
    return memory;
}

} // namespace raywise
