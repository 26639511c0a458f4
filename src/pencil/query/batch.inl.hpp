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

/// Rays of a batch, and where they are. Arrays, so that lanes can be rays.
struct Together {
    alignas(64) std::array<float, together> x, y, z; ///< origin, or direction away from an apex
    alignas(64) std::array<float, together> t;       ///< what `Spot` depends on: t_min, or t_max
    alignas(64) std::array<std::array<std::int32_t, together>, 4> units; ///< of `Spot`
    std::array<PrimId, together> excluded;
    std::array<const Face*, together> faces;
    std::array<Where, together> where;

    [[nodiscard]] HWY_INLINE Spot spot(std::size_t i) const {
        return {faces[i], {units[0][i], units[1][i], units[2][i], units[3][i]}};
    }
};

/// `locate` of the first rays, shadow rays of a parallel pencil: as many at a time as doubles fit a
/// vector.
HWY_INLINE void locate_parallel(const Grid& grid, std::size_t count, Together& rays) {
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
        const auto length = load(rays.t);
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

/// `locate` of the first rays, shadow rays of a radial pencil: each of a vector has a face of its
/// own.
HWY_INLINE void locate_radial(const Grid& grid, std::size_t count, Together& rays) {
    const hn::CappedTag<double, together> d;
    const hn::Rebind<float, decltype(d)> floats;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    const hn::RebindToSigned<decltype(d)> indices;
    constexpr auto stride = static_cast<double>(sizeof(Face) / sizeof(double));
    const auto zero = hn::Zero(d);
    const auto one = hn::Set(d, 1.0);
    for (std::size_t first = 0; first < count; first += hn::Lanes(d)) {
        const auto load = [&](const std::array<float, together>& row)
                              HWY_ATTR { return hn::PromoteTo(d, hn::Load(floats, &row[first])); };
        const auto x = hn::Sub(load(rays.x), hn::Set(d, grid.apex.x));
        const auto y = hn::Sub(load(rays.y), hn::Set(d, grid.apex.y));
        const auto z = hn::Sub(load(rays.z), hn::Set(d, grid.apex.z));
        const auto t = load(rays.t);
        // As face_of does.
        const auto across = hn::Max(hn::Abs(x), hn::Abs(y));
        const auto distance = hn::Max(across, hn::Abs(z));
        const auto is_z = hn::Gt(hn::Abs(z), across);
        const auto is_x = hn::Ge(hn::Abs(x), distance);
        const auto along = [&](auto of_x, auto of_y, auto of_z) HWY_ATTR {
            return hn::IfThenElse(is_x, of_x, hn::IfThenElse(is_z, of_z, of_y));
        };
        const auto is_negative = hn::Lt(along(x, y, z), zero);
        const auto face = hn::Add(
            along(zero, hn::Set(d, 2.0), hn::Set(d, 4.0)), hn::IfThenElseZero(is_negative, one)
        );
        const auto at = hn::ConvertTo(indices, hn::Mul(face, hn::Set(d, stride)));
        const FaceMap& map = grid.faces[0].map;
        const auto of_face = [&](const double& member)
                                 HWY_ATTR { return hn::GatherIndex(d, &member, at); };
        const auto inverse = hn::Div(one, distance);
        const auto u = hn::MulSub(
            hn::Mul(along(y, z, x), inverse), of_face(map.scale_u), of_face(map.offset_u)
        );
        const auto v = hn::MulSub(
            hn::Mul(along(z, x, y), inverse), of_face(map.scale_v), of_face(map.offset_v)
        );
        const auto is_within = [&](auto place, auto size) HWY_ATTR {
            return hn::And(hn::Ge(place, zero), hn::Lt(place, size));
        };
        const auto is_inside = hn::And(
            hn::And(is_within(u, of_face(map.size_u)), is_within(v, of_face(map.size_v))),
            hn::Le(distance, hn::Set(d, map.reach))
        );
        const auto length = hn::Mul(t, distance);
        const auto scale = of_face(map.depth_scale);
        const auto depth = [&](std::size_t lane) HWY_ATTR {
            const auto left = hn::MulAdd(hn::Set(d, map.toward[lane]), length, distance);
            const auto end = hn::Div(scale, hn::Max(left, hn::Set(d, least_distance[lane])));
            return hn::Max(
                hn::Min(hn::Sub(of_face(map.columns[3][lane]), end), hn::Set(d, deepest)), zero
            );
        };
        const auto is_sure = hn::Le(t, of_face(map.most_t));
        const auto put = [&](std::size_t lane, auto value) HWY_ATTR {
            hn::Store(hn::DemoteTo(integers, value), integers, &rays.units[lane][first]);
        };
        const auto within = [&](auto place) HWY_ATTR {
            return hn::Max(hn::Min(place, hn::Set(d, depth_limit[0])), zero);
        };
        put(0, within(u));
        put(1, within(v));
        put(2, hn::IfThenElse(is_sure, depth(2), hn::Set(d, deepest)));
        put(3,
            hn::IfThenElse(
                is_sure, hn::Sub(depth(3), hn::Set(d, rounding)), hn::Set(d, nothing_sure)
            ));
        alignas(64) std::array<double, together> faces, inside; // NOLINT(*-member-init)
        hn::Store(face, d, faces.data());
        hn::Store(hn::IfThenElseZero(is_inside, one), d, inside.data());
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
            const std::size_t i = first + lane;
            rays.faces[i] = &grid.faces[static_cast<std::size_t>(faces[lane])];
            rays.where[i] = inside[lane] == 1 ? Where::inside : Where::unknown;
        }
    }
}

/// `locate` of the first rays, shadow rays that pass all geometry.
HWY_INLINE void locate_shadows(const Grid& grid, std::size_t count, float t_max, Together& rays) {
    if (grid.pencil.kind() == Pencil::Kind::parallel)
        locate_parallel(grid, count, rays);
    else
        locate_radial(grid, count, rays);
    for (std::size_t i = 0; i < count; ++i)
        if (rays.where[i] != Where::inside) [[unlikely]] {
            const Vec3 origin{rays.x[i], rays.y[i], rays.z[i]};
            rays.where[i] = where_else<Heading::to_emitter>(
                grid, {origin, origin, rays.t[i], t_max}, rays.faces[i]->map
            );
        }
}

/// `locate` of the first rays, which come from the apex, as far as they see the first one's face;
/// others are `unknown`. Those that pass geometry before they begin are not noticed.
HWY_INLINE void locate_from_apex(const Grid& grid, std::size_t count, Together& rays) {
    const hn::CappedTag<double, together> d;
    const hn::Rebind<float, decltype(d)> floats;
    const hn::Rebind<std::int32_t, decltype(d)> integers;
    double longest = 0;
    const Vec3 first_ray{rays.x[0], rays.y[0], rays.z[0]};
    const Face& face = grid.faces[face_of(to_double(first_ray), longest)];
    const FaceMap& map = face.map;
    const std::array<const float*, 3> rows{rays.x.data(), rays.y.data(), rays.z.data()};
    for (std::size_t first = 0; first < count; first += hn::Lanes(d)) {
        const auto load = [&](const float* row)
                              HWY_ATTR { return hn::PromoteTo(d, hn::Load(floats, row + first)); };
        const auto along = [&](int axis)
                               HWY_ATTR { return load(rows[static_cast<std::size_t>(axis)]); };
        const auto z = hn::Mul(along(map.axis), hn::Set(d, map.sign));
        const auto inverse = hn::Div(hn::Set(d, 1.0), z);
        const auto across = [&](int axis, double scale, double offset) HWY_ATTR {
            const auto slope = hn::Mul(along(axis), inverse);
            return hn::MulSub(slope, hn::Set(d, scale), hn::Set(d, offset));
        };
        const auto u = across(map.axis_u, map.scale_u, map.offset_u);
        const auto v = across(map.axis_v, map.scale_v, map.offset_v);
        const auto zero = hn::Zero(d);
        const auto is_within = [&](auto place, double size) HWY_ATTR {
            return hn::And(hn::Ge(place, zero), hn::Lt(place, hn::Set(d, size)));
        };
        // A face lists what is a little beyond its edges, too.
        const auto edge = hn::Mul(z, hn::Set(d, 1 + 0x1p-6));
        const auto sees_face = hn::And(
            hn::Gt(z, zero),
            hn::And(
                hn::Le(hn::Abs(along(map.axis_u)), edge), hn::Le(hn::Abs(along(map.axis_v)), edge)
            )
        );
        const auto is_inside = hn::And(is_within(u, map.size_u), is_within(v, map.size_v));
        const auto length = hn::Mul(load(rays.t.data()), z);
        const auto inverse_length =
            hn::Div(hn::Set(d, 1.0), hn::Max(length, hn::Set(d, least_distance[2])));
        const auto depth = [&](std::size_t lane) HWY_ATTR {
            const double scale = map.dividend[lane] / map.away[lane];
            const auto end =
                hn::MulAdd(hn::Set(d, scale), inverse_length, hn::Set(d, map.columns[3][lane]));
            return hn::Max(hn::Min(end, hn::Set(d, depth_limit[lane])), zero);
        };
        const auto put = [&](std::size_t lane, auto value) HWY_ATTR {
            hn::Store(hn::DemoteTo(integers, value), integers, &rays.units[lane][first]);
        };
        put(0, u);
        put(1, v);
        put(2, depth(2));
        put(3, depth(3));
        // 0 where another face must be asked, 1 where nothing is, else 2.
        const auto one = hn::Set(d, 1.0);
        const auto kind =
            hn::IfThenElseZero(sees_face, hn::Add(one, hn::IfThenElseZero(is_inside, one)));
        alignas(64) std::array<double, together> kinds; // NOLINT(*-member-init): written next
        hn::Store(kind, d, kinds.data());
        for (std::size_t lane = 0; lane < hn::Lanes(d); ++lane) {
            constexpr std::array<Where, 3> wheres{Where::unknown, Where::outside, Where::inside};
            const std::size_t i = first + lane;
            rays.faces[i] = &face;
            rays.units[3][i] -= rounding;
            rays.where[i] = wheres[static_cast<std::size_t>(kinds[lane])];
        }
    }
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#endif
