// Paths through a scene: where its eyes' rays arrive, and where they go on from there.
#pragma once

#include "analysis/workload/eye.hpp"
#include "analysis/workload/place.hpp"

#include <raywise/analysis/exact_oracle.hpp>
#include <raywise/analysis/ray_workload.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstddef>
#include <span>
#include <vector>

namespace raywise::workload_detail {

/// A point of a path on a surface, and the side that the path sees.
struct SurfacePoint {
    bool is_there = false;
    Vec3 point;
    Vec3d normal; ///< unit, toward where the path came from
};

/// What the paths of one eye met.
struct Paths {
    std::vector<Ray> primary;
    std::vector<Ray> bounce; ///< invalid (zero direction) where the primary ray met nothing
    std::vector<SurfacePoint> first;
    std::vector<SurfacePoint> second;
};

/// Keeps references to all that it is made from.
class PathTracer {
public:
    PathTracer(
        const Place& place,
        const ExactOracle& oracle,
        const WorkloadParams& params,
        const Executor& executor
    )
        : place_(place), oracle_(oracle), params_(params), executor_(executor) {}

    /// How far from a surface its rays start, in scene units.
    [[nodiscard]] float offset() const {
        return static_cast<float>(params_.offset * place_.diagonal);
    }

    /// The first `count` paths of the eye.
    [[nodiscard]] Paths trace(const Eye& eye, std::size_t number, std::size_t count) const;

    /// Through points of the lens and the pixels of the paths.
    [[nodiscard]] std::vector<Ray>
    lens_rays(const Eye& eye, std::size_t number, std::size_t count, double radius) const;

private:
    /// Tiles lie evenly over the picture, each at a random place in its share.
    [[nodiscard]] std::vector<Ray>
    primary_rays(const Eye& eye, std::size_t number, std::size_t count) const;

    [[nodiscard]] std::vector<SurfacePoint> surface_points(std::span<const Ray> rays) const;

    const Place& place_;
    const ExactOracle& oracle_;
    const WorkloadParams& params_;
    const Executor& executor_;
};

} // namespace raywise::workload_detail
