// The suns and lamps of a workload.
#pragma once

#include "analysis/workload/path_tracer.hpp"
#include "analysis/workload/place.hpp"

#include <raywise/analysis/ray_class.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/geometry/frame.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>

#include <cstddef>
#include <cstdint>
#include <string>

namespace raywise::workload_detail {

/// "sun 1", "sun 2", ...: of the emitter or eye with this number.
[[nodiscard]] std::string area_name(RayClass rays, std::size_t number);

/// The shadow rays of one sun or lamp.
class Emitter {
public:
    Emitter(const Place& place, RayClass rays, std::uint64_t seed, std::size_t number);

    [[nodiscard]] const InfluenceArea& area() const { return area_; }

    /// From a point to the emitter; not valid where the surface faces away. `draw` numbers the rays
    /// of this emitter.
    [[nodiscard]] Ray shadow_ray(const SurfacePoint& from, float offset, std::uint64_t draw) const;

private:
    [[nodiscard]] Ray unbounded_ray(Vec3 point, std::uint64_t draw) const;

    RayClass rays_;
    std::uint64_t seed_;
    InfluenceArea area_;
    Pencil pencil_;
    Frame sky_; ///< forward is toward a sun
    double radius_ = 0;
};

} // namespace raywise::workload_detail
