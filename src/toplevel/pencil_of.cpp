#include <raywise/toplevel/pencil_of.hpp>

#include <raywise/distribution/influence_area.hpp>
#include <raywise/distribution/parallel.hpp>
#include <raywise/distribution/radial.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>

#include <optional>
#include <variant>

namespace raywise {

std::optional<Pencil> central_pencil_of(const InfluenceArea& area) {
    if (const auto* parallel = std::get_if<ParallelDistribution>(&area.distribution)) {
        return Pencil::parallel(to_float(parallel->params().frame.forward));
    }
    if (const auto* radial = std::get_if<RadialDistribution>(&area.distribution)) {
        const Vec3 apex = to_float(radial->params().eye);
        if (is_finite(apex)) return Pencil::radial(apex);
    }
    return std::nullopt;
}

std::optional<Pencil> pencil_of(const InfluenceArea& area) {
    const auto* parallel = std::get_if<ParallelDistribution>(&area.distribution);
    const auto* radial = std::get_if<RadialDistribution>(&area.distribution);
    const bool is_blurred = (parallel != nullptr && parallel->params().cone_half_angle_deg > 0) ||
                            (radial != nullptr && radial->params().radius > 0);
    return is_blurred ? std::nullopt : central_pencil_of(area);
}

} // namespace raywise
