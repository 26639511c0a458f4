// Bodies of the watched queries, see accelerator.hpp. The proof of exactness in short: a region is
// convex and holds the origin, so the ray is inside it on exactly [0, exit]; every triangle hit
// there overlaps the region and so stands in the local tree. What that tree finds up to the exit is
// final, what it finds beyond is a real hit that bounds the rest, and what remains is the global
// tree's.
#pragma once

#include <raywise/toplevel/accelerator.hpp> // IWYU pragma: keep
#include <raywise/trace/all_hits.hpp>

#include <algorithm>
#include <type_traits>
#include <vector>

namespace raywise {

namespace detail {

/// A grid's steps in the words of trees: a cell is a node, a list a leaf.
[[nodiscard]] constexpr Counts steps_of(const PencilGridCounts& counts) {
    return {
        .boxes = counts.cells, .inners = counts.cells, .leaves = counts.lists, .prims = counts.prims
    };
}

/// Asks a grid, counting only for those who watch.
template <class Observer, class Ask>
Verdict ask_watched(AreaId area, const Ray& ray, Observer& seen, Ask&& ask) {
    seen.search(area, ray.t_min, ray.t_max);
    PencilGridCounts counts;
    const Verdict verdict = ask(counts);
    seen.steps(steps_of(counts));
    if (verdict == Verdict::hit) seen.found();
    return verdict;
}

} // namespace detail

template <class Observer>
Verdict Accelerator::closest_in_grid(AreaId area, const Ray& ray, Hit& hit, Observer& seen) const {
    const PencilGrid* grid = local(area).grid.get();
    if (grid == nullptr || !grid->pencil().holds(ray)) return Verdict::unknown;
    if constexpr (std::is_same_v<Observer, SilentQuery>) return grid->closest_hit(ray, hit);
    return detail::ask_watched(area, ray, seen, [&](PencilGridCounts& counts) {
        return grid->closest_hit(ray, hit, counts);
    });
}

template <class Observer>
Verdict Accelerator::any_in_grid(AreaId area, const Ray& ray, Observer& seen) const {
    const PencilGrid* grid = local(area).grid.get();
    if (grid == nullptr || !grid->pencil().holds(ray)) return Verdict::unknown;
    if constexpr (std::is_same_v<Observer, SilentQuery>) return grid->any_hit(ray);
    return detail::ask_watched(area, ray, seen, [&](PencilGridCounts& counts) {
        return grid->any_hit(ray, counts);
    });
}

template <class Observer>
std::optional<Hit>
Accelerator::closest_among(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    // No unknown hit is left before rest.t_min, and none beyond rest.t_max can be the closest.
    Ray rest = ray;
    std::optional<Hit> best;
    const auto search = [&](const TracedTree& tree) {
        const auto hit = tree.closest_hit(rest, seen, params_.trace_mode);
        if (!hit || (best && !is_closer(*hit, *best))) return;
        best = hit;
        rest.t_max = hit->t;
        seen.found();
    };
    for (std::size_t i = 0; i < candidates.count; ++i) {
        const Candidate& candidate = candidates.items[i];
        if (candidate.exit <= rest.t_min) continue;
        const LocalStructure& structure = local(candidate.area);
        seen.search(candidate.area, rest.t_min, rest.t_max);
        search(structure.tree);
        if (rest.t_max <= candidate.exit) return best;
        rest.t_min = candidate.exit;
    }
    seen.search(std::nullopt, rest.t_min, rest.t_max);
    search(global_tree_);
    return best;
}

template <class Observer>
bool Accelerator::any_among(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    Ray rest = ray;
    const auto search = [&](const TracedTree& tree) {
        const bool hit = tree.any_hit(rest, seen, params_.trace_mode);
        if (hit) seen.found();
        return hit;
    };
    for (std::size_t i = 0; i < candidates.count; ++i) {
        const Candidate& candidate = candidates.items[i];
        if (candidate.exit <= rest.t_min) continue;
        const LocalStructure& structure = local(candidate.area);
        seen.search(candidate.area, rest.t_min, rest.t_max);
        // A hit beyond the exit is as real an occluder as one before it.
        if (search(structure.tree)) return true;
        if (rest.t_max <= candidate.exit) return false;
        rest.t_min = candidate.exit;
    }
    seen.search(std::nullopt, rest.t_min, rest.t_max);
    return search(global_tree_);
}

template <class Observer>
std::optional<Hit>
Accelerator::first_hit_wins(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    for (std::size_t i = 0; i < candidates.count; ++i) {
        const LocalStructure& structure = local(candidates.items[i].area);
        seen.search(candidates.items[i].area, ray.t_min, ray.t_max);
        const auto hit = structure.tree.closest_hit(ray, seen, params_.trace_mode);
        if (hit) {
            seen.found();
            return hit;
        }
    }
    seen.search(std::nullopt, ray.t_min, ray.t_max);
    const auto hit = global_tree_.closest_hit(ray, seen, params_.trace_mode);
    if (hit) seen.found();
    return hit;
}

template <class Observer>
std::optional<Hit>
Accelerator::closest_by_mode(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    return params_.mode == QueryMode::exact ? closest_among(ray, candidates, seen)
                                            : first_hit_wins(ray, candidates, seen);
}

template <class Observer>
bool Accelerator::any_by_mode(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    return params_.mode == QueryMode::exact ? any_among(ray, candidates, seen)
                                            : first_hit_wins(ray, candidates, seen).has_value();
}

template <QueryObserver Observer>
std::optional<Hit> Accelerator::closest_hit(const Ray& ray, Observer& seen) const {
    if (!is_valid(ray)) return std::nullopt;
    for (const Gridded& gridded : with_grid_) {
        Hit hit;
        const Verdict verdict = closest_in_grid(gridded.area, ray, hit, seen);
        if (verdict != Verdict::unknown)
            return verdict == Verdict::hit ? std::optional(hit) : std::nullopt;
    }
    return closest_by_mode(ray, candidates_of(ray), seen);
}

template <QueryObserver Observer>
bool Accelerator::any_hit(const Ray& ray, Observer& seen) const {
    if (!is_valid(ray)) return false;
    for (const Gridded& gridded : with_grid_) {
        const Verdict verdict = any_in_grid(gridded.area, ray, seen);
        if (verdict != Verdict::unknown) return verdict == Verdict::hit;
    }
    return any_by_mode(ray, candidates_of(ray), seen);
}

template <class Visitor>
void Accelerator::all_hits(const Ray& ray, Visitor&& visit) const {
    if (!is_valid(ray)) return;
    std::vector<Hit> hits;
    const auto collect = [&](const Hit& hit) { hits.push_back(hit); };
    Ray rest = ray;
    const Candidates candidates = candidates_of(ray);
    bool is_done = false;
    if (params_.mode == QueryMode::exact && candidates.count > 0 &&
        candidates.items[0].exit > ray.t_min) {
        rest.t_max = std::min(ray.t_max, candidates.items[0].exit);
        local(candidates.items[0].area).tree.all_hits(rest, collect, params_.trace_mode);
        is_done = rest.t_max == ray.t_max;
        rest.t_min = rest.t_max;
        rest.t_max = ray.t_max;
    }
    if (!is_done) global_tree_.all_hits(rest, collect, params_.trace_mode);
    // A hit at the exit, or of a triangle that stands in several leaves, was found twice.
    sort_hits(hits);
    for (const Hit& hit : hits)
        visit(hit);
}

template <QueryObserver Observer>
std::optional<Hit> AreaHandle::closest_hit(const Ray& ray, Observer& seen) const {
    if (!is_valid(ray)) return std::nullopt;
    Hit hit;
    const Verdict verdict = owner_->closest_in_grid(id_, ray, hit, seen);
    if (verdict != Verdict::unknown)
        return verdict == Verdict::hit ? std::optional(hit) : std::nullopt;
    return owner_->closest_by_mode(ray, owner_->candidates_in(id_, ray), seen);
}

template <QueryObserver Observer>
bool AreaHandle::any_hit(const Ray& ray, Observer& seen) const {
    if (!is_valid(ray)) return false;
    const Verdict verdict = owner_->any_in_grid(id_, ray, seen);
    if (verdict != Verdict::unknown) return verdict == Verdict::hit;
    return owner_->any_by_mode(ray, owner_->candidates_in(id_, ray), seen);
}

} // namespace raywise
