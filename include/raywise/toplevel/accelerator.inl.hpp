// Bodies of the watched queries, see accelerator.hpp. The proof of exactness in short: a region is
// convex and holds the origin, so the ray is inside it on exactly [0, exit]; every triangle hit
// there overlaps the region and so stands in the local tree. What that tree finds up to the exit is
// final, what it finds beyond is a real hit that bounds the rest, and what remains is the global
// tree's.
#pragma once

#include <raywise/toplevel/accelerator.hpp> // IWYU pragma: keep
#include <raywise/trace/all_hits.hpp>
#include <raywise/trace/any_hit.hpp>
#include <raywise/trace/closest_hit.hpp>

#include <cmath>
#include <limits>
#include <utility>

namespace raywise {

template <class Observer>
std::optional<Hit>
Accelerator::closest_among(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    // No unknown hit is left before rest.t_min, and none beyond rest.t_max can be the closest.
    Ray rest = ray;
    std::optional<Hit> best;
    const auto search = [&](const Bvh& tree, const PackedTriangles& triangles) {
        const auto hit = raywise::closest_hit(tree, triangles, rest, seen);
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
        search(structure.tree, structure.triangles);
        if (rest.t_max <= candidate.exit) return best;
        rest.t_min = candidate.exit;
    }
    seen.search(std::nullopt, rest.t_min, rest.t_max);
    search(global_tree_, global_triangles_);
    return best;
}

template <class Observer>
bool Accelerator::any_among(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    Ray rest = ray;
    const auto search = [&](const Bvh& tree, const PackedTriangles& triangles) {
        const bool hit = raywise::any_hit(tree, triangles, rest, seen);
        if (hit) seen.found();
        return hit;
    };
    for (std::size_t i = 0; i < candidates.count; ++i) {
        const Candidate& candidate = candidates.items[i];
        if (candidate.exit <= rest.t_min) continue;
        const LocalStructure& structure = local(candidate.area);
        seen.search(candidate.area, rest.t_min, rest.t_max);
        // A hit beyond the exit is as real an occluder as one before it.
        if (search(structure.tree, structure.triangles)) return true;
        if (rest.t_max <= candidate.exit) return false;
        rest.t_min = candidate.exit;
    }
    seen.search(std::nullopt, rest.t_min, rest.t_max);
    return search(global_tree_, global_triangles_);
}

template <class Observer>
std::optional<Hit>
Accelerator::first_hit_wins(const Ray& ray, const Candidates& candidates, Observer& seen) const {
    for (std::size_t i = 0; i < candidates.count; ++i) {
        const LocalStructure& structure = local(candidates.items[i].area);
        seen.search(candidates.items[i].area, ray.t_min, ray.t_max);
        const auto hit = raywise::closest_hit(structure.tree, structure.triangles, ray, seen);
        if (hit) {
            seen.found();
            return hit;
        }
    }
    seen.search(std::nullopt, ray.t_min, ray.t_max);
    const auto hit = raywise::closest_hit(global_tree_, global_triangles_, ray, seen);
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
    return closest_by_mode(ray, candidates_of(ray), seen);
}

template <QueryObserver Observer>
bool Accelerator::any_hit(const Ray& ray, Observer& seen) const {
    return is_valid(ray) && any_by_mode(ray, candidates_of(ray), seen);
}

template <class Visitor>
void Accelerator::all_hits(const Ray& ray, Visitor&& visit) const {
    if (!is_valid(ray)) return;
    Ray rest = ray;
    const Candidates candidates = candidates_of(ray);
    if (params_.mode == QueryMode::exact && candidates.count > 0 &&
        candidates.items[0].exit > ray.t_min) {
        const LocalStructure& structure = local(candidates.items[0].area);
        rest.t_max = std::min(ray.t_max, candidates.items[0].exit);
        raywise::all_hits(structure.tree, structure.triangles, rest, visit);
        if (rest.t_max == ray.t_max) return;
        // The global part is open at the exit, or hits there would be reported twice.
        rest.t_min = std::nextafter(rest.t_max, std::numeric_limits<float>::infinity());
        rest.t_max = ray.t_max;
    }
    raywise::all_hits(global_tree_, global_triangles_, rest, visit);
}

template <QueryObserver Observer>
std::optional<Hit> AreaHandle::closest_hit(const Ray& ray, Observer& seen) const {
    if (!is_valid(ray)) return std::nullopt;
    return owner_->closest_by_mode(ray, owner_->candidates_in(id_, ray), seen);
}

template <QueryObserver Observer>
bool AreaHandle::any_hit(const Ray& ray, Observer& seen) const {
    return is_valid(ray) && owner_->any_by_mode(ray, owner_->candidates_in(id_, ray), seen);
}

} // namespace raywise
