// The edges of a triangle as linear functions on one tile of a picture.
#pragma once

#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <hwy/base.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace raywise::detail {

/// u * x + v * y + k, for the point (x, y) relative to the tile's center, of the edge opposite of
/// each vertex; positive inside. Raised by a bound on all errors: a ray surely misses where one is
/// negative, and surely hits where all are above `sure`.
struct Edges {
    std::array<float, 3> u, v, k;
    float sure;
    /// Whether the side that is seen is known. Otherwise the functions are not raised, and a ray
    /// surely misses where one is above `sure` and another below -`sure`.
    bool one_sided;
    float depth_lo, depth_hi; ///< of the triangle, outward
    float bound;              ///< by which the functions are raised, at least
    bool has_plane;           ///< whether depths inside the triangle may be computed
    bool is_flat;             ///< whether they are functions of the triangle's points (u, v)
    // Of one that is not flat:
    double volume;       ///< sum of h times the function opposite, in the functions' units
    double volume_error; ///< relative
};

HWY_INLINE void set_depths(Edges& edges, const Drawn& t) {
    const double error = 0x1p-50 * t.size + 0x1p-145;
    edges.depth_lo = static_cast<float>(t.depth_lo - error - 0x1p-23 * std::abs(t.depth_lo));
    edges.depth_hi = static_cast<float>(t.depth_hi + error + 0x1p-23 * std::abs(t.depth_hi));
}

/// The corners of a flat triangle relative to a tile's center, each within 2^-24 of itself.
struct FlatCorners {
    std::array<float, 3> x, y;
    float x_lo, x_hi, y_lo, y_hi;
    float greatest; ///< coordinate by magnitude
    float extent;   ///< greatest difference of coordinates, about
};

HWY_INLINE FlatCorners flat_corners(const Drawn& t, const Tile& tile) {
    FlatCorners corners; // NOLINT(*-member-init)
    auto& [x, y, x_lo, x_hi, y_lo, y_hi, greatest, extent] = corners;
    for (std::size_t i = 0; i < 3; ++i) {
        x[i] = static_cast<float>(t.u[i] - tile.u);
        y[i] = static_cast<float>(t.v[i] - tile.v);
    }
    x_lo = least_of(x[0], x[1], x[2]);
    x_hi = greatest_of(x[0], x[1], x[2]);
    y_lo = least_of(y[0], y[1], y[2]);
    y_hi = greatest_of(y[0], y[1], y[2]);
    greatest = greater(greater(-x_lo, x_hi), greater(-y_lo, y_hi));
    extent = greater(x_hi - x_lo, y_hi - y_lo);
    return corners;
}

/// For a flat triangle of ordinary size; false when float's range does not do.
///
/// With e = 2^-24, M the largest coordinate of a vertex, L that of a vertex or a ray, both relative
/// to the tile, and D the largest difference of vertices: vertices are within e M, rays within e L,
/// so k = x y' - y x' is within 6 e M^2 + 2 e M D, its factors u and v within 2 e M + e D, and
/// evaluating u x + v y + k adds at most 7 e D L + 6 e M D and, for the rays, 2 e D L. Summed, that
/// is under e L (10 M + 17 D); 16 and 24 cover second order terms and the rounding of the bound.
/// Doubles are off by `noise` at most, and rays meet the triangle up to `aside` of where they are
/// seen.
HWY_INLINE bool make_flat_edges(
    Edges& edges,
    const Drawn& t,
    const Tile& tile,
    const FlatCorners& corners,
    float noise,
    float aside
) {
    const auto& [x, y, x_lo, x_hi, y_lo, y_hi, across, extent] = corners;
    const float greatest = greater(across, greater(tile.half_u, tile.half_v));
    if (!(across > 0x1p-50F && greatest < 0x1p50F)) return false;
    const float bound = greatest * (0x1p-20F * across + 1.5F * 0x1p-20F * extent + 16 * noise) +
                        2.1F * extent * aside + 0x1p-120F;
    const float side = t.side > 0 ? 1.0F : -1.0F;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t a = (i + 1) % 3;
        const std::size_t b = (i + 2) % 3;
        edges.u[i] = (y[a] - y[b]) * side;
        edges.v[i] = (x[b] - x[a]) * side;
        edges.k[i] = (x[a] * y[b] - y[a] * x[b]) * side + bound;
    }
    edges.sure = 2.01F * bound;
    edges.bound = bound;
    edges.one_sided = true;
    edges.is_flat = true;
    edges.has_plane = true;
    set_depths(edges, t);
    return true;
}

/// For any triangle. Each coordinate of a vertex is within `noise` of the exact one; rounding n and
/// k to float and evaluating n x + k costs at most 6 e of each |n x| and 4 e of |k|.
template <bool is_radial>
void make_edges(Edges& edges, const Drawn& t, const Tile& tile, double aside) {
    const auto half_u = static_cast<double>(tile.half_u);
    const auto half_v = static_cast<double>(tile.half_v);
    std::array<double, 3> x{}, y{}, h{};
    double across = 0;
    double along = is_radial ? 0 : 1;
    for (std::size_t i = 0; i < 3; ++i) {
        h[i] = t.p[i].h;
        x[i] = t.p[i].x - tile.u * h[i];
        y[i] = t.p[i].y - tile.v * h[i];
        across = greater(across, greater(std::abs(x[i]), std::abs(y[i])));
        if constexpr (is_radial) along = greater(along, std::abs(h[i]));
    }
    const double noise =
        0x1p-50 *
        (t.size + along * (greater(std::abs(tile.u), std::abs(tile.v)) + half_u + half_v));
    const double k_error = 20 * noise * (across + noise);
    const double n_error = 4 * noise * (along + (is_radial ? across : 0));
    std::array<double, 3> u{}, v{}, k{};
    double greatest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t a = (i + 1) % 3;
        const std::size_t b = (i + 2) % 3;
        u[i] = y[a] * h[b] - h[a] * y[b];
        v[i] = h[a] * x[b] - x[a] * h[b];
        k[i] = x[a] * y[b] - y[a] * x[b];
        greatest = greater(
            greatest,
            greater(std::abs(k[i]), greater(std::abs(u[i]) * half_u, std::abs(v[i]) * half_v))
        );
    }
    const double volume = h[0] * k[0] + h[1] * k[1] + h[2] * k[2];
    const double volume_error = 8 * greater(along, is_radial ? across : 0) * k_error;
    int side = t.side;
    edges.is_flat = false;
    edges.one_sided = true;
    if constexpr (is_radial) {
        side = volume > 0 ? 1 : -1;
        edges.one_sided = std::abs(volume) > volume_error;
    }
    edges.has_plane = std::abs(volume) > 0x1p8 * volume_error && volume * side > 0;
    edges.volume_error = edges.has_plane ? volume_error / std::abs(volume) : 1;
    // A power of two that keeps products of floats in range.
    double scale = side;
    if (!(greatest > 0x1p-60 && greatest < 0x1p60) && greatest > 0)
        scale = std::ldexp(scale, -std::ilogb(greatest));
    double bound = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const double du = std::abs(u[i]);
        const double dv = std::abs(v[i]);
        bound = greater(
            bound,
            (du + dv) * (aside + noise + 0x1p-148) +
                8 * 0x1p-24 * (du * half_u + dv * half_v + std::abs(k[i])) +
                n_error * (half_u + half_v + aside) + k_error
        );
    }
    bound = bound * std::abs(scale) * (1 + 0x1p-20) + 0x1p-120;
    for (std::size_t i = 0; i < 3; ++i) {
        edges.u[i] = static_cast<float>(u[i] * scale);
        edges.v[i] = static_cast<float>(v[i] * scale);
        edges.k[i] = static_cast<float>(k[i] * scale + (edges.one_sided ? bound : 0));
    }
    edges.bound = static_cast<float>(bound * (1 + 0x1p-20));
    edges.sure = edges.bound * (edges.one_sided ? 2.01F : 1.01F);
    edges.volume = volume * scale;
    set_depths(edges, t);
}

/// Rows of a picture between the edges of a triangle.
class RowClipper {
public:
    explicit RowClipper(const Edges& edges) : edges_(edges) {
        for (std::size_t i = 0; i < 3; ++i)
            per_u_[i] = edges.u[i] != 0 ? -1 / edges.u[i] : 0;
    }

    /// The range of x in which all edges may be positive for some y in [lo, hi], but for roundings
    /// of 2^-21 of the ends; false: nowhere.
    [[nodiscard]] bool operator()(float lo, float hi, float& from, float& to) const {
        if (!edges_.one_sided) return true;
        for (std::size_t i = 0; i < 3; ++i) {
            const float rest =
                greater(edges_.v[i] * lo, edges_.v[i] * hi) + edges_.k[i] + edges_.sure;
            if (edges_.u[i] > 0) {
                from = greater(from, rest * per_u_[i]);
            } else if (edges_.u[i] < 0) {
                to = lesser(to, rest * per_u_[i]);
            } else if (rest < 0) {
                return false;
            }
        }
        return from <= to;
    }

private:
    const Edges& edges_;
    std::array<float, 3> per_u_{};
};

} // namespace raywise::detail
