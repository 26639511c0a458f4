// Measured rays: a weighted record of the rays that a renderer shot. After [Bittner09]; ours: exact
// counting that narrows with the builder, shrinkage toward uniform lines.
#pragma once

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace raywise {

/// A ray and how often it was shot.
struct RecordedRay {
    Ray ray;           ///< valid; ends at t_max, finite or not
    double weight = 1; ///< >= 0, finite
};

struct MeasuredParams {
    std::vector<RecordedRay> rays; ///< at least one; positive total weight; at most 2^32 - 1
    Aabb bounds; ///< of the scene: the box of the uniform lines that unseen boxes fall back
                 ///< on; finite, with positive surface area
    double shrinkage = 1; ///< weight of those uniform lines, in the unit of the rays' weights;
                          ///< >= 0, finite; 0: the bare counted share
};

/// The record itself, immutable and shared by every copy of a measure of it.
struct RayRecord;

/// (weight of the recorded rays that meet the box + shrinkage p) / (total weight + shrinkage), p
/// that of UniformMeasure: unseen boxes are not free. Exactly monotone. Cost: one ray-box test for
/// each ray of the measure; `narrowed` leaves those that can matter.
class MeasuredMeasure {
public:
    explicit MeasuredMeasure(std::shared_ptr<const RayRecord> record);

    [[nodiscard]] float operator()(const Aabb& box) const;

    /// The same measure inside `box`, counting only the rays that meet it. O(rays) time and memory.
    [[nodiscard]] MeasuredMeasure narrowed(const Aabb& box) const;

    /// Share of the recorded weight that meets both boxes; uniform lines do not count.
    [[nodiscard]] double shared(const Aabb& a, const Aabb& b) const;

    /// Number of rays that an evaluation tests.
    [[nodiscard]] std::size_t ray_count() const { return selected_->size(); }

private:
    std::shared_ptr<const RayRecord> record_;
    std::shared_ptr<const std::vector<std::uint32_t>> selected_;
};

/// Draws recorded rays with probability proportional to their weights. Copies share the record.
class MeasuredDistribution {
public:
    /// Throws Error with the first parameter out of its range.
    explicit MeasuredDistribution(MeasuredParams params);

    [[nodiscard]] const MeasuredParams& params() const;

    /// A mixture like the measure: a recorded ray, or with probability shrinkage / (total weight +
    /// shrinkage) a uniform chord of the bounds.
    [[nodiscard]] Ray sample(Rng& rng) const;

    /// Probability (not a density) of drawing exactly this recorded ray; O(rays). Chords of the
    /// shrinkage do not count.
    [[nodiscard]] double density(const Ray& ray) const;

    [[nodiscard]] MeasuredMeasure measure() const { return MeasuredMeasure(record_); }

    /// Mean absolute unit direction of the rays that meet the box; of all rays when none does.
    /// O(rays).
    [[nodiscard]] Vec3d direction_at(const Aabb& box) const;

private:
    std::shared_ptr<const RayRecord> record_;
};

} // namespace raywise
