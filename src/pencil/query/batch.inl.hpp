// Shadow rays of a batch: places of many at a time. Included once for every instruction set.
#if defined(RAYWISE_PENCIL_QUERY_BATCH) == defined(HWY_TARGET_TOGGLE)
#ifdef RAYWISE_PENCIL_QUERY_BATCH
#undef RAYWISE_PENCIL_QUERY_BATCH
#else
#define RAYWISE_PENCIL_QUERY_BATCH
#endif

#include "pencil/query/locate.inl.hpp"

#include <hwy/highway.h>

#include <array>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

/// Rays that are answered together: while one waits for memory, the others go on.
constexpr std::size_t together = 32;

/// Shadow rays that pass all geometry, and where they are. Arrays, so that lanes can be rays.
struct Shadows {
    alignas(64) std::array<float, together> x, y, z, t_min;
    alignas(64) std::array<std::array<std::int32_t, together>, 4> units; ///< of `Spot`
    std::array<PrimId, together> excluded;
    std::array<const Face*, together> faces;
    std::array<Where, together> where;

    [[nodiscard]] HWY_INLINE Spot spot(std::size_t i) const {
        return {faces[i], {units[0][i], units[1][i], units[2][i], units[3][i]}};
    }
};

/// `locate` of the first rays, for a parallel pencil: as many at a time as doubles fit a vector.
HWY_INLINE void locate_parallel(const Grid& grid, std::size_t count, Shadows& rays) {
    const hn::CappedTag<double, together> d;
    const hn::Rebind<float, decltype(d)> floats;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    const Face& face = grid.faces[0];
    const FaceMap& map = face.map;
    for (std::size_t first = 0; first < count; first += hn::Lanes(d)) {
        const auto load = [&](const std::array<float, together>& row)
                              HWY_ATTR { return hn::PromoteTo(d, hn::Load(floats, &row[first])); };
        const auto x = load(rays.x);
        const auto y = load(rays.y);
        const auto z = load(rays.z);
        const auto length = load(rays.t_min);
        auto is_inside = hn::Eq(hn::Zero(d), hn::Zero(d));
        for (std::size_t lane = 0; lane < 4; ++lane) {
            const auto column = [&](std::size_t i)
                                    HWY_ATTR { return hn::Set(d, map.columns[i][lane]); };
            auto sum = hn::MulAdd(
                column(0), x, hn::MulAdd(column(1), y, hn::MulAdd(column(2), z, column(3)))
            );
            is_inside = hn::And(
                is_inside,
                hn::And(
                    hn::Ge(sum, hn::Set(d, map.least[lane])),
                    hn::Lt(sum, hn::Set(d, map.limit[lane]))
                )
            );
            sum = hn::MulAdd(hn::Set(d, map.toward[lane]), length, sum);
            sum = hn::Max(hn::Min(sum, hn::Set(d, depth_limit[lane])), hn::Zero(d));
            hn::Store(hn::DemoteTo(integers, sum), integers, &rays.units[lane][first]);
        }
        const auto marks = hn::IfThenElseZero(is_inside, hn::Set(d, 1.0));
        std::array<double, together> inside; // NOLINT(*-member-init): written next
        hn::StoreU(marks, d, inside.data());
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
            const std::size_t i = first + lane;
            rays.faces[i] = &face;
            rays.units[3][i] -= rounding;
            rays.where[i] = inside[lane] == 1 ? Where::inside : Where::unknown;
        }
    }
}

/// `locate` of the first rays.
HWY_INLINE void locate_all(const Grid& grid, std::size_t count, float t_max, Shadows& rays) {
    const auto segment = [&](std::size_t i, const Vec3& origin)
                             HWY_ATTR { return Segment{origin, origin, rays.t_min[i], t_max}; };
    const bool is_parallel = grid.pencil.kind() == Pencil::Kind::parallel;
    if (is_parallel) locate_parallel(grid, count, rays);
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3 origin{rays.x[i], rays.y[i], rays.z[i]};
        if (!is_parallel) {
            Spot spot{};
            rays.where[i] = locate<Heading::to_emitter>(grid, segment(i, origin), spot);
            rays.faces[i] = spot.face;
            for (std::size_t k = 0; k < 4; ++k)
                rays.units[k][i] = spot.units[k];
        } else if (rays.where[i] != Where::inside) [[unlikely]] {
            rays.where[i] =
                where_else<Heading::to_emitter>(grid, segment(i, origin), grid.faces[0].map);
        }
    }
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
