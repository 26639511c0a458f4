#include "pencil/footprint.hpp"
#include "pencil/piece.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

// A ray whose place a query puts at p passes the piece within margin - 1 of p, and the snapped
// piece has a point of equal depth within 1 of that: so bounds enlarged by the margin have all
// places, and over these, enlarged by the margin again, the plane has all depths.
namespace raywise::pencil_detail {

namespace {

struct Bounds {
    std::int64_t least_u, greatest_u, least_v, greatest_v;
};

Bounds widened(const Window& window, std::int32_t margin) {
    return {
        std::int64_t{window.first_u} - margin,
        std::int64_t{window.first_u} + window.side + margin,
        std::int64_t{window.first_v} - margin,
        std::int64_t{window.first_v} + window.side + margin
    };
}

/// Whether the window, enlarged to `bounds`, is strictly inside the snapped piece.
bool is_inside(const Piece& piece, const Bounds& bounds) {
    const auto at = [&](std::size_t i) {
        return std::pair(std::int64_t{piece.u[i % 3]}, std::int64_t{piece.v[i % 3]});
    };
    const auto [u0, v0] = at(0);
    const auto [u1, v1] = at(1);
    const auto [u2, v2] = at(2);
    const std::int64_t area = (u1 - u0) * (v2 - v0) - (v1 - v0) * (u2 - u0);
    if (area == 0) return false;
    const std::int64_t turn = area > 0 ? 1 : -1;
    for (std::size_t i = 0; i < 3; ++i) {
        const auto [au, av] = at(i);
        const auto [bu, bv] = at(i + 1);
        const std::int64_t du = (bu - au) * turn;
        const std::int64_t dv = (bv - av) * turn;
        // Least value of the edge function over the window's corners.
        const std::int64_t least = du * ((du > 0 ? bounds.least_v : bounds.greatest_v) - av) -
                                   dv * ((dv > 0 ? bounds.greatest_u : bounds.least_u) - au);
        if (least <= 0) return false;
    }
    return true;
}

/// The plane of a piece: key = key_at + slope_u * (u - at_u) + slope_v * (v - at_v), in units.
struct KeyPlane {
    double at_u, at_v;
    double key_at;
    double slope_u, slope_v;

    [[nodiscard]] double at(double u, double v) const {
        return key_at + slope_u * (u - at_u) + slope_v * (v - at_v);
    }
};

/// Slopes are right to 2^-30, relatively to the steepest; nothing for pieces seen too much from
/// their edge.
std::optional<KeyPlane> key_plane(const Piece& piece) {
    const double du1 = piece.u[1] - piece.u[0], dv1 = piece.v[1] - piece.v[0];
    const double du2 = piece.u[2] - piece.u[0], dv2 = piece.v[2] - piece.v[0];
    const double area = du1 * dv2 - dv1 * du2;
    const double longest = std::max({std::abs(du1), std::abs(dv1), std::abs(du2), std::abs(dv2)});
    if (!(std::abs(area) > longest * longest * 0x1p-16)) return std::nullopt;
    const double dk1 = static_cast<double>(piece.key[1]) - static_cast<double>(piece.key[0]);
    const double dk2 = static_cast<double>(piece.key[2]) - static_cast<double>(piece.key[0]);
    return KeyPlane{
        static_cast<double>(piece.u[0]),
        static_cast<double>(piece.v[0]),
        static_cast<double>(piece.key[0]),
        (dk1 * dv2 - dk2 * dv1) / area,
        (dk2 * du1 - dk1 * du2) / area
    };
}

constexpr Footprint nothing{1, 0, 1, 0, 0, 0};

} // namespace

bool fills(const Piece& piece, const Window& window) {
    const Extremes u(piece.u);
    const Extremes v(piece.v);
    const Bounds wide = widened(window, piece.margin);
    return u.least < wide.least_u && u.greatest > wide.greatest_u && v.least < wide.least_v &&
           v.greatest > wide.greatest_v && is_inside(piece, wide);
}

Footprint footprint(const Piece& piece, const Window& window) {
    const std::int32_t m = piece.margin;
    const Extremes u(piece.u);
    const Extremes v(piece.v);
    const Extremes key(piece.key);
    const std::int32_t last_u = window.first_u + window.side - 1;
    const std::int32_t last_v = window.first_v + window.side - 1;
    if (u.least - m > last_u || u.greatest + m < window.first_u || v.least - m > last_v ||
        v.greatest + m < window.first_v)
        return nothing;
    Footprint place{
        std::max(u.least - m, window.first_u),
        std::min(u.greatest + m, last_u),
        std::max(v.least - m, window.first_v),
        std::min(v.greatest + m, last_v),
        static_cast<double>(key.least),
        static_cast<double>(key.greatest)
    };
    if (u.greatest - u.least <= window.side && v.greatest - v.least <= window.side) return place;
    if (const auto plane = key_plane(piece)) {
        const double half_u = 0.5 * (place.greatest_u + 1 - place.least_u);
        const double half_v = 0.5 * (place.greatest_v + 1 - place.least_v);
        const double middle = plane->at(place.least_u + half_u, place.least_v + half_v);
        const double change = std::abs(plane->slope_u) * (half_u + m + 1) +
                              std::abs(plane->slope_v) * (half_v + m + 1) +
                              (place.greatest_key - place.least_key) * 0x1p-26;
        place.least_key = std::max(place.least_key, middle - change);
        place.greatest_key = std::min(place.greatest_key, middle + change);
    }
    return place;
}

} // namespace raywise::pencil_detail
