// A hit measure with a grain of surface area in it, so that boxes no ray meets still compare.
#pragma once

#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/hit_measure.hpp>

#include <utility>

namespace raywise {

/// (1 - share) p_measure + share p_surface, both conditional on meeting the root: in [0, 1] for
/// boxes inside the root. Without the grain every split of a box outside the rays costs 0, and ties
/// peel primitives off one by one. A part whose root has no mass counts 0, so a root that no ray
/// meets leaves pure surface area.
template <HitMeasure M>
class MixedMeasure {
public:
    /// `surface_share` in [0, 1].
    MixedMeasure(M measure, const Aabb& root, double surface_share = 0.1)
        : measure_(std::move(measure))
        , measure_factor_(factor(1.0 - surface_share, static_cast<float>(measure_(root))))
        , surface_factor_(factor(surface_share, half_area(root))) {}

    [[nodiscard]] float operator()(const Aabb& box) const {
        const auto mass = static_cast<double>(static_cast<float>(measure_(box)));
        const auto area = static_cast<double>(half_area(box));
        return static_cast<float>(mass * measure_factor_ + area * surface_factor_);
    }

    /// The same mixture for boxes inside `box`.
    [[nodiscard]] MixedMeasure narrowed(const Aabb& box) const
        requires NarrowableMeasure<M>
    {
        return MixedMeasure(measure_.narrowed(box), measure_factor_, surface_factor_);
    }

private:
    MixedMeasure(M measure, double measure_factor, double surface_factor)
        : measure_(std::move(measure))
        , measure_factor_(measure_factor)
        , surface_factor_(surface_factor) {}

    static double factor(double share, float root_mass) {
        return root_mass > 0 ? share / static_cast<double>(root_mass) : 0.0;
    }

    M measure_;
    double measure_factor_;
    double surface_factor_;
};

static_assert(HitMeasure<MixedMeasure<SurfaceMeasure>>);

} // namespace raywise
