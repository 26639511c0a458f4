#include "pencil/footprint.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

// A ray whose place a query puts at p passes the piece within margin - 1 of p, and the snapped
// piece has a point of equal depth within 1 of that: so the snapped piece, cut by the window
// enlarged by the margin, has all depths and, enlarged by the margin again, all places.
namespace raywise::pencil_detail {

namespace {

struct Corner {
    std::array<double, 2> at; ///< u, v
    double key;
};

/// A triangle cut by four lines has at most seven corners.
struct Polygon {
    std::array<Corner, 8> corners;
    std::size_t count = 0;

    void add(const Corner& corner) { corners[count++] = corner; }
};

/// The part with sign * (at[axis] - limit) <= 0. [Sutherland74]
template <std::size_t Axis>
void cut(Polygon& polygon, double limit, double sign) {
    Polygon kept;
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Corner& a = polygon.corners[i];
        const Corner& b = polygon.corners[i + 1 == polygon.count ? 0 : i + 1];
        const double beyond_a = sign * (a.at[Axis] - limit);
        const double beyond_b = sign * (b.at[Axis] - limit);
        if (beyond_a <= 0) kept.add(a);
        if ((beyond_a < 0 && beyond_b > 0) || (beyond_a > 0 && beyond_b < 0)) {
            const double share = beyond_a / (beyond_a - beyond_b);
            Corner crossing{};
            crossing.at[Axis] = limit;
            crossing.at[1 - Axis] = a.at[1 - Axis] + share * (b.at[1 - Axis] - a.at[1 - Axis]);
            crossing.key = a.key + share * (b.key - a.key);
            kept.add(crossing);
        }
    }
    polygon = kept;
}

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

std::int32_t limited(double value, std::int32_t least, std::int32_t greatest) {
    return static_cast<std::int32_t>(
        std::clamp(value, static_cast<double>(least), static_cast<double>(greatest))
    );
}

struct Extent {
    double least_u, greatest_u, least_v, greatest_v;
    double least_key, greatest_key;
};

Extent extent(const Polygon& polygon) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    Extent e{infinity, -infinity, infinity, -infinity, infinity, -infinity};
    for (std::size_t i = 0; i < polygon.count; ++i) {
        const Corner& corner = polygon.corners[i];
        e.least_u = std::min(e.least_u, corner.at[0]);
        e.greatest_u = std::max(e.greatest_u, corner.at[0]);
        e.least_v = std::min(e.least_v, corner.at[1]);
        e.greatest_v = std::max(e.greatest_v, corner.at[1]);
        e.least_key = std::min(e.least_key, corner.key);
        e.greatest_key = std::max(e.greatest_key, corner.key);
    }
    return e;
}

constexpr Footprint nothing{1, 0, 1, 0, 0, 0};

} // namespace

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

bool fills(const Piece& piece, const Window& window) {
    const auto [low_u, high_u] = std::minmax({piece.u[0], piece.u[1], piece.u[2]});
    const auto [low_v, high_v] = std::minmax({piece.v[0], piece.v[1], piece.v[2]});
    const Bounds wide = widened(window, piece.margin);
    return low_u < wide.least_u && high_u > wide.greatest_u && low_v < wide.least_v &&
           high_v > wide.greatest_v && is_inside(piece, wide);
}

Footprint footprint(const Piece& piece, const Window& window) {
    const std::int32_t m = piece.margin;
    const auto [low_u, high_u] = std::minmax({piece.u[0], piece.u[1], piece.u[2]});
    const auto [low_v, high_v] = std::minmax({piece.v[0], piece.v[1], piece.v[2]});
    const std::int32_t last_u = window.first_u + window.side - 1;
    const std::int32_t last_v = window.first_v + window.side - 1;
    if (low_u - m > last_u || high_u + m < window.first_u || low_v - m > last_v ||
        high_v + m < window.first_v)
        return nothing;
    const auto [least_key, greatest_key] = std::minmax({piece.key[0], piece.key[1], piece.key[2]});
    if (high_u - low_u <= window.side && high_v - low_v <= window.side)
        return {
            std::max(low_u - m, window.first_u),
            std::min(high_u + m, last_u),
            std::max(low_v - m, window.first_v),
            std::min(high_v + m, last_v),
            static_cast<double>(least_key),
            static_cast<double>(greatest_key)
        };

    const Bounds wide = widened(window, m);
    if (fills(piece, window)) {
        double least = static_cast<double>(least_key);
        double greatest = static_cast<double>(greatest_key);
        if (const auto plane = key_plane(piece)) {
            const double middle =
                plane->at(window.first_u + window.side * 0.5, window.first_v + window.side * 0.5);
            const double change = (std::abs(plane->slope_u) + std::abs(plane->slope_v)) *
                                      (window.side * 0.5 + m + 1) +
                                  (greatest - least) * 0x1p-26;
            least = std::max(least, middle - change);
            greatest = std::min(greatest, middle + change);
        }
        return {window.first_u, last_u, window.first_v, last_v, least, greatest};
    }

    Polygon polygon;
    for (std::size_t i = 0; i < 3; ++i)
        polygon.add(
            {{static_cast<double>(piece.u[i]), static_cast<double>(piece.v[i])},
             static_cast<double>(piece.key[i])}
        );
    if (low_u < wide.least_u) cut<0>(polygon, static_cast<double>(wide.least_u), -1);
    if (high_u > wide.greatest_u) cut<0>(polygon, static_cast<double>(wide.greatest_u), 1);
    if (low_v < wide.least_v) cut<1>(polygon, static_cast<double>(wide.least_v), -1);
    if (high_v > wide.greatest_v) cut<1>(polygon, static_cast<double>(wide.greatest_v), 1);
    if (polygon.count == 0) return nothing;
    const Extent e = extent(polygon);
    if (e.least_u - m > last_u || e.greatest_u + m < window.first_u || e.least_v - m > last_v ||
        e.greatest_v + m < window.first_v)
        return nothing;
    return {
        limited(std::floor(e.least_u) - m, window.first_u, last_u),
        limited(std::ceil(e.greatest_u) + m, window.first_u, last_u),
        limited(std::floor(e.least_v) - m, window.first_v, last_v),
        limited(std::ceil(e.greatest_v) + m, window.first_v, last_v),
        e.least_key,
        e.greatest_key
    };
}

} // namespace raywise::pencil_detail
