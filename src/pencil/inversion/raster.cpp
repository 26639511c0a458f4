// Triangles drawn over rays, several rays per operation. After [Aila04], [Johnson05].
//
// A triangle is drawn picture by picture, tile by tile, row of bins by row of bins; a row's part
// between the edges is one run of slots. Lanes answer "surely missed" or "surely hit, at a depth
// surely inside"; the rest is decided exactly.

// The same instructions as a neighbor's, or no gain here: fewer copies of the code.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pencil/inversion/raster.cpp"
#include "pencil/inversion/facing.hpp"
#include "pencil/inversion/raster.hpp"

#include <raywise/geometry/ray_triangle.hpp>

#include <hwy/foreach_target.h> // first: includes this file once per instruction set
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

constexpr double double_infinity = std::numeric_limits<double>::infinity();

/// A triangle in one picture.
struct Drawn {
    PrimId id;
    std::array<FacePoint, 3> p;
    double depth_lo, depth_hi;
    double u_lo, u_hi, v_lo, v_hi; ///< where it may be seen; unbounded when it reaches behind
    double size;                   ///< no coordinate's magnitude is greater
    double distance; ///< from the apex, in the largest of the coordinates; at most the true one
    int side;        ///< sign of the volume, when it is known already; 0 otherwise
};

/// The edges of a triangle as functions of a point of one tile, for its float lanes. Positive
/// inside. Each is raised by its bound: surely negative where it is negative, surely positive where
/// it is above `sure`.
struct Edges {
    std::array<float, 3> u, v, k;
    std::array<float, 3> sure;
    bool one_sided; ///< whether the sign of the inside is known; else both sides are asked
    float depth_lo, depth_hi;
    double volume; ///< sum of h times the opposite edge function
    double scale;  ///< exact values times this are the ones above
    double sum_bound;
    bool has_plane;      ///< whether the volume is known well enough for depths inside the triangle
    double volume_error; ///< relative
};

/// Holds a tile against other threads.
class TileLock {
public:
    explicit TileLock(Tile& tile) : tile_(tile) {
        while (tile_.busy.exchange(true, std::memory_order_acquire))
            while (tile_.busy.load(std::memory_order_relaxed)) {
            }
    }
    ~TileLock() { tile_.busy.store(false, std::memory_order_release); }
    TileLock(const TileLock&) = delete;
    TileLock& operator=(const TileLock&) = delete;
    TileLock(TileLock&&) = delete;
    TileLock& operator=(TileLock&&) = delete;

private:
    Tile& tile_;
};

template <bool is_radial, bool is_closest>
class Drawing {
public:
    explicit Drawing(const Raster& raster) : raster_(raster), tiles_(raster.tiles) {
        for (const Window& window : tiles_.windows)
            brink_ = std::max(brink_, window.brink);
    }

    void draw(PrimId id) {
        const Triangle triangle = raster_.triangles[id];
        if (!is_finite(triangle.v0) || !is_finite(triangle.v1) || !is_finite(triangle.v2)) return;
        Drawn drawn{};
        drawn.id = id;
        for (std::size_t f = 0; f < tiles_.faces.size(); ++f) {
            const Window& window = tiles_.windows[f];
            if (window.is_empty()) continue;
            const Face& face = tiles_.faces[f];
            drawn.p = {face.point(triangle.v0), face.point(triangle.v1), face.point(triangle.v2)};
            if constexpr (is_radial) {
                measure(drawn);
                // Rays that end at the apex pass it by a rounding, rays that start there may hit
                // what touches it from any side: no picture shows that.
                if (drawn.distance <= brink_) {
                    ask_all(id);
                    return;
                }
                if (std::max({drawn.p[0].h, drawn.p[1].h, drawn.p[2].h}) <= 0) continue;
            } else {
                measure(drawn);
                drawn.side = 0;
            }
            draw_face(drawn, face, window, triangle);
        }
    }

private:
    using D = hn::ScalableTag<float>;
    using DU = hn::RebindToUnsigned<D>;
    using V = hn::Vec<D>;
    using Mask = hn::Mask<D>;

    static void measure(Drawn& t) {
        const auto& [a, b, c] = t.p;
        t.depth_lo = std::min(std::min(a.depth, b.depth), c.depth);
        t.depth_hi = std::max(std::max(a.depth, b.depth), c.depth);
        const double x_lo = std::min(std::min(a.x, b.x), c.x);
        const double x_hi = std::max(std::max(a.x, b.x), c.x);
        const double y_lo = std::min(std::min(a.y, b.y), c.y);
        const double y_hi = std::max(std::max(a.y, b.y), c.y);
        t.size = std::max(
            std::max(std::max(-x_lo, x_hi), std::max(-y_lo, y_hi)),
            std::max(-t.depth_lo, t.depth_hi)
        );
        t.u_lo = x_lo;
        t.u_hi = x_hi;
        t.v_lo = y_lo;
        t.v_hi = y_hi;
        if constexpr (is_radial) {
            t.distance = std::max(
                std::max(std::max(x_lo, -x_hi), std::max(y_lo, -y_hi)),
                std::max(std::max(t.depth_lo, -t.depth_hi), 0.0)
            );
            if (t.distance < 0x1p-6 * t.size) t.distance = std::max(t.distance, plane_distance(t));
        }
    }

    /// A lower bound on the plane's distance from the apex, in the largest of the coordinates.
    static double plane_distance(const Drawn& t) {
        const auto vec = [](const FacePoint& p) { return Vec3d{p.x, p.y, p.h}; };
        const Vec3d a = vec(t.p[0]);
        const Vec3d p = vec(t.p[1]) - a;
        const Vec3d q = vec(t.p[2]) - a;
        const Vec3d normal = abs(cross(p, q));
        const double volume = std::abs(dot(a, cross(p, q))) - 0x1p-46 * t.size * t.size * t.size;
        const double error = 0x1p-46 * t.size * t.size;
        return volume > 0 ? volume / (normal.x + normal.y + normal.z + error) : 0;
    }

    /// By how much, in the picture, a ray of this reach may be off where it meets the triangle.
    ///
    /// The float direction of a shadow ray is off by 2^-24 in each component, so at depth z,
    /// started at depth s, the ray is seen at most 2 |u| 2^-24 |s / z - 1| aside, |u| <= 1. A point
    /// where it meets a triangle at distance r > 8 * 2^-24 s is seen in the doubled window, hence z
    /// >= r / 2.
    static double deviation(const Drawn& t, double reach) {
        const double nearest =
            std::max(t.distance / 2, std::min(std::min(t.p[0].h, t.p[1].h), t.p[2].h));
        return 2.1 * 0x1p-24 * std::max(1.0, reach / nearest);
    }

    void draw_face(Drawn& t, const Face& face, const Window& window, const Triangle& triangle) {
        double slack = 0x1p-48 * t.size;
        if constexpr (is_radial) {
            slack = 0x1p-44 + (window.reach > 0 ? deviation(t, window.reach) : 0);
            const auto& [a, b, c] = t.p;
            if (std::min(std::min(a.h, b.h), c.h) > 0x1p-30 * t.size) {
                const std::array<double, 3> us{a.x / a.h, b.x / b.h, c.x / c.h};
                const std::array<double, 3> vs{a.y / a.h, b.y / b.h, c.y / c.h};
                t.u_lo = std::min(std::min(us[0], us[1]), us[2]);
                t.u_hi = std::max(std::max(us[0], us[1]), us[2]);
                t.v_lo = std::min(std::min(vs[0], vs[1]), vs[2]);
                t.v_hi = std::max(std::max(vs[0], vs[1]), vs[2]);
                slack += 0x1p-48 * std::max(std::max(-t.u_lo, t.u_hi), std::max(-t.v_lo, t.v_hi));
            } else {
                // Reaches behind: what is beside the window wholly is not seen.
                const double room = slack + 0x1p-40;
                const auto beside = [&](auto signed_distance) {
                    return signed_distance(a) > 0 && signed_distance(b) > 0 &&
                           signed_distance(c) > 0;
                };
                const double noise = 0x1p-44 * t.size;
                if (beside([&](auto& p) { return p.x - (window.u_hi + room) * p.h - noise; }) ||
                    beside([&](auto& p) { return (window.u_lo - room) * p.h - p.x - noise; }) ||
                    beside([&](auto& p) { return p.y - (window.v_hi + room) * p.h - noise; }) ||
                    beside([&](auto& p) { return (window.v_lo - room) * p.h - p.y - noise; }))
                    return;
                t.u_lo = t.v_lo = -double_infinity;
                t.u_hi = t.v_hi = double_infinity;
            }
        }
        t.u_lo -= slack;
        t.u_hi += slack;
        t.v_lo -= slack;
        t.v_hi += slack;
        if (t.u_lo > window.u_hi || t.u_hi < window.u_lo || t.v_lo > window.v_hi ||
            t.v_hi < window.v_lo)
            return;
        if constexpr (!is_radial) {
            if (!find_side(t, face, triangle)) return;
        }
        const std::uint32_t column_lo = window.column(t.u_lo), column_hi = window.column(t.u_hi);
        const std::uint32_t row_lo = window.row(t.v_lo), row_hi = window.row(t.v_hi);
        Tile* const tiles = tiles_.tiles.data() + window.first_tile;
        if (column_hi - column_lo < 2 || row_lo == row_hi) {
            for (std::uint32_t row = row_lo; row <= row_hi; ++row)
                for (std::uint32_t column = column_lo; column <= column_hi; ++column)
                    draw_tile(t, face, tiles[row * window.columns + column]);
            return;
        }
        // Long in both directions: walk the rows between the edges.
        Tile whole;
        whole.u = (window.u_lo + window.u_hi) / 2;
        whole.v = (window.v_lo + window.v_hi) / 2;
        whole.half_u = static_cast<float>((window.u_hi - window.u_lo) * 0.50001);
        whole.half_v = static_cast<float>((window.v_hi - window.v_lo) * 0.50001);
        whole.start = static_cast<float>(window.reach);
        const Edges edges = make_edges(t, whole);
        const double extra = 0x1p-18 * static_cast<double>(whole.half_v);
        for (std::uint32_t row = row_lo; row <= row_hi; ++row) {
            double lo = window.v_lo;
            double hi = window.v_hi;
            if (row > 0) lo = window.v + row / window.per_v - extra;
            if (row + 1 < window.rows) hi = window.v + (row + 1) / window.per_v + extra;
            float from = -whole.half_u, to = whole.half_u;
            if (!clip_row(
                    edges,
                    static_cast<float>(lo - whole.v),
                    static_cast<float>(hi - whole.v),
                    from,
                    to
                ))
                continue;
            const double room = 0x1p-18 * static_cast<double>(whole.half_u);
            const std::uint32_t first =
                std::max(column_lo, window.column(whole.u + static_cast<double>(from) - room));
            const std::uint32_t last =
                std::min(column_hi, window.column(whole.u + static_cast<double>(to) + room));
            for (std::uint32_t column = first; column <= last; ++column)
                draw_tile(t, face, tiles[row * window.columns + column]);
        }
    }

    /// The range of u in which all edges may be positive for some v in [lo, hi].
    static bool clip_row(const Edges& edges, float lo, float hi, float& from, float& to) {
        if (!edges.one_sided) return true;
        for (std::size_t i = 0; i < 3; ++i) {
            const float rest =
                std::max(edges.v[i] * lo, edges.v[i] * hi) + edges.k[i] + edges.sure[i];
            if (edges.u[i] > 0) {
                from = std::max(from, -rest / edges.u[i]);
            } else if (edges.u[i] < 0) {
                to = std::min(to, -rest / edges.u[i]);
            } else if (rest < 0) {
                return false;
            }
        }
        return from <= to;
    }

    /// For a parallel pencil: which way the triangle faces. False: it is seen edge-on, and never
    /// hit.
    bool find_side(Drawn& t, const Face& face, const Triangle& triangle) const {
        const auto& [a, b, c] = t.p;
        const double left = (b.x - a.x) * (c.y - a.y);
        const double right = (b.y - a.y) * (c.x - a.x);
        // Differences are within 2^-49 of the size.
        const double across = std::max(
            std::max(std::abs(b.x - a.x), std::abs(c.x - a.x)),
            std::max(std::abs(b.y - a.y), std::abs(c.y - a.y))
        );
        const double error = 0x1p-49 * t.size;
        const double bound = 4 * error * (across + error) + 0x1p-50 * across * across;
        const double area = left - right;
        if (std::abs(area) > bound) {
            t.side = area > 0 ? 1 : -1;
            return true;
        }
        const Vec3 direction = raster_.pencil.direction();
        const int sign = exact_facing(direction, triangle);
        t.side = direction[dominant_axis(direction)] < 0 ? -sign : sign;
        static_cast<void>(face);
        return sign != 0;
    }

    /// With e = 2^-24: each coordinate of a vertex is within `noise` of the exact one; a lane's u
    /// and v are within e of the tile's half size, and a ray deviates. Rounding n, k to float and
    /// evaluating n . q + k costs at most 6 e of each |n q| and 4 e of |k|.
    static Edges make_edges(const Drawn& t, const Tile& tile) {
        const auto half_u = static_cast<double>(tile.half_u);
        const auto half_v = static_cast<double>(tile.half_v);
        std::array<double, 3> x{}, y{}, h{};
        double across = 0;
        double along = is_radial ? 0 : 1;
        for (std::size_t i = 0; i < 3; ++i) {
            h[i] = t.p[i].h;
            x[i] = t.p[i].x - tile.u * h[i];
            y[i] = t.p[i].y - tile.v * h[i];
            across = std::max(across, std::max(std::abs(x[i]), std::abs(y[i])));
            if constexpr (is_radial) along = std::max(along, std::abs(h[i]));
        }
        const double noise =
            0x1p-50 *
            (t.size + along * (std::max(std::abs(tile.u), std::abs(tile.v)) + half_u + half_v));
        const double k_error = 20 * noise * (across + noise);
        const double n_error = 4 * noise * (along + (is_radial ? across : 0));
        double aside = 0;
        if constexpr (is_radial) {
            if (tile.start > 0) aside = deviation(t, static_cast<double>(tile.start));
        }
        std::array<double, 3> u{}, v{}, k{};
        for (std::size_t i = 0; i < 3; ++i) { // the edge opposite of vertex i
            const std::size_t a = (i + 1) % 3;
            const std::size_t b = (i + 2) % 3;
            u[i] = y[a] * h[b] - h[a] * y[b];
            v[i] = h[a] * x[b] - x[a] * h[b];
            k[i] = x[a] * y[b] - y[a] * x[b];
        }
        const double volume = h[0] * k[0] + h[1] * k[1] + h[2] * k[2];
        Edges edges{};
        edges.one_sided = true;
        int side = t.side;
        const double volume_error = 8 * std::max(along, is_radial ? across : 0) * k_error;
        if constexpr (is_radial) {
            side = volume > 0 ? 1 : -1;
            edges.one_sided = std::abs(volume) > volume_error;
        }
        edges.has_plane = std::abs(volume) > 0x1p8 * volume_error && volume * side > 0;
        edges.volume_error = edges.has_plane ? volume_error / std::abs(volume) : 1;
        // A power of two that keeps products of floats in range.
        double greatest = 0;
        for (std::size_t i = 0; i < 3; ++i)
            greatest = std::max(
                greatest,
                std::max(std::abs(k[i]), std::max(std::abs(u[i]) * half_u, std::abs(v[i]) * half_v))
            );
        edges.scale = side;
        if (!(greatest > 0x1p-60 && greatest < 0x1p60) && greatest > 0)
            edges.scale = std::ldexp(edges.scale, -std::ilogb(greatest));
        const double scale = edges.scale;
        const double grown = std::abs(scale);
        for (std::size_t i = 0; i < 3; ++i) {
            const double du = std::abs(u[i]);
            const double dv = std::abs(v[i]);
            const double bound = (du + dv) * (aside + noise + 0x1p-148) +
                                 8 * 0x1p-24 * (du * half_u + dv * half_v + std::abs(k[i])) +
                                 n_error * (half_u + half_v + aside) + k_error;
            const double raised = bound * grown * (1 + 0x1p-20) + 0x1p-120;
            edges.u[i] = static_cast<float>(u[i] * scale);
            edges.v[i] = static_cast<float>(v[i] * scale);
            edges.k[i] = static_cast<float>(k[i] * scale + (edges.one_sided ? raised : 0));
            edges.sure[i] = static_cast<float>(raised * (edges.one_sided ? 2.001 : 1.001));
            edges.sum_bound += raised;
        }
        edges.volume = volume * scale;
        const double depth_error = 0x1p-50 * t.size + 0x1p-145;
        edges.depth_lo =
            static_cast<float>(t.depth_lo - depth_error - 0x1p-23 * std::abs(t.depth_lo));
        edges.depth_hi =
            static_cast<float>(t.depth_hi + depth_error + 0x1p-23 * std::abs(t.depth_hi));
        return edges;
    }

    void draw_tile(const Drawn& t, const Face& face, Tile& tile) {
        if (tile.undecided.load(std::memory_order_relaxed) == 0) return;
        // Outward, so that rounding never skips a tile.
        if (t.depth_lo * (1 + std::copysign(0x1p-22, -t.depth_lo)) >
                static_cast<double>(tile.far) ||
            t.depth_hi * (1 + std::copysign(0x1p-22, t.depth_hi)) < static_cast<double>(tile.near))
            return;
        const double room_u = 8 * 0x1p-24 * static_cast<double>(tile.half_u) + 0x1p-148;
        const double room_v = 8 * 0x1p-24 * static_cast<double>(tile.half_v) + 0x1p-148;
        const double u_lo = t.u_lo - tile.u - room_u;
        const double u_hi = t.u_hi - tile.u + room_u;
        const double v_lo = t.v_lo - tile.v - room_v;
        const double v_hi = t.v_hi - tile.v + room_v;
        const auto half_u = static_cast<double>(tile.half_u);
        const auto half_v = static_cast<double>(tile.half_v);
        if (u_lo > half_u || u_hi < -half_u || v_lo > half_v || v_hi < -half_v) return;
        const Edges edges = make_edges(t, tile);
        const auto clamped = [](double x, double half) {
            return static_cast<float>(std::clamp(x, -half, half));
        };
        const std::uint32_t column_lo = tile.column(clamped(u_lo, half_u));
        const std::uint32_t column_hi = tile.column(clamped(u_hi, half_u));
        const std::uint32_t row_lo = tile.row(clamped(v_lo, half_v));
        const std::uint32_t row_hi = tile.row(clamped(v_hi, half_v));
        const TileLock lock(tile);
        const std::uint32_t* const starts = &tiles_.bin_starts[tile.bins];
        const bool is_narrow = column_hi - column_lo < 2 || row_lo == row_hi;
        const float extra = 0x1p-20F * tile.half_v;
        const float room = 0x1p-18F * tile.half_u;
        const float per_row = tile.per_v > 0 ? 1 / tile.per_v : 0;
        for (std::uint32_t row = row_lo; row <= row_hi; ++row) {
            std::uint32_t first = column_lo;
            std::uint32_t last = column_hi;
            if (!is_narrow) {
                float lo = -tile.half_v, hi = tile.half_v;
                if (row > 0) lo = tile.v0 + static_cast<float>(row) * per_row - extra;
                if (row + 1 < tile.rows)
                    hi = tile.v0 + static_cast<float>(row + 1) * per_row + extra;
                float from = -tile.half_u, to = tile.half_u;
                if (!clip_row(edges, lo, hi, from, to)) continue;
                first = std::max(first, tile.column(from - room));
                last = std::min(last, tile.column(to + room));
                if (first > last) continue;
            }
            const std::uint32_t* const row_starts = starts + row * tile.columns;
            draw_run(
                t,
                edges,
                face,
                tile,
                tile.first + row_starts[first],
                tile.first + row_starts[last + 1]
            );
        }
        const std::uint32_t undecided = tile.undecided.load(std::memory_order_relaxed);
        if (undecided * 2 < tile.count && tile.count > 32) drop_decided(tile);
    }

    /// Depth bounds of the lanes' points, from the plane.
    void
    plane_depth(const Drawn& t, const Edges& edges, V e0, V e1, V e2, V& least, V& most) const {
        const D d;
        if constexpr (is_radial) {
            const V sum = hn::Add(hn::Add(e0, e1), e2); // raised by the bounds
            const V volume = hn::Set(d, static_cast<float>(edges.volume));
            const auto bound = static_cast<float>(edges.sum_bound * 2.1);
            const V high = hn::Mul(sum, hn::Set(d, 1 + 0x1p-20F));
            const V low = hn::Sub(hn::Mul(sum, hn::Set(d, 1 - 0x1p-20F)), hn::Set(d, bound));
            const V nearest = hn::Div(volume, high);
            const V farthest = hn::IfThenElse(
                hn::Gt(low, hn::Zero(d)),
                hn::Div(volume, low),
                hn::Set(d, std::numeric_limits<float>::infinity())
            );
            const auto unsure = static_cast<float>(edges.volume_error * 1.01) + 0x1p-20F;
            const V shrunk = hn::Mul(nearest, hn::Set(d, 1 - unsure));
            const V grown = hn::Mul(farthest, hn::Set(d, 1 + unsure));
            least = shrunk;
            most = grown;
            if (reversed_) {
                least = hn::Neg(grown);
                most = hn::Neg(shrunk);
            }
        } else {
            const double inverse = 1 / edges.volume;
            const double b = t.p[1].depth - t.p[0].depth;
            const double c = t.p[2].depth - t.p[0].depth;
            const double change = std::abs(b) + std::abs(c);
            const auto error = static_cast<float>(
                change * (2 * edges.sum_bound * std::abs(inverse) + 16 * 0x1p-24) *
                    (1 + 2 * edges.volume_error) +
                change * 1.01 * edges.volume_error + 0x1p-22 * std::abs(t.p[0].depth) +
                0x1p-48 * t.size + 0x1p-145
            );
            const V depth = hn::Add(
                hn::Set(d, static_cast<float>(t.p[0].depth)),
                hn::MulAdd(
                    e1,
                    hn::Set(d, static_cast<float>(b * inverse)),
                    hn::Mul(e2, hn::Set(d, static_cast<float>(c * inverse)))
                )
            );
            least = hn::Sub(depth, hn::Set(d, error));
            most = hn::Add(depth, hn::Set(d, error));
        }
        least = hn::Max(least, hn::Set(d, edges.depth_lo));
        most = hn::Min(most, hn::Set(d, edges.depth_hi));
    }

    /// Asks the rays of the slots [first, last), and maybe some after them.
    void draw_run(
        const Drawn& t,
        const Edges& edges,
        const Face& face,
        Tile& tile,
        std::uint32_t first,
        std::uint32_t last
    ) {
        const D d;
        const DU du;
        const V depth_lo = hn::Set(d, edges.depth_lo);
        const V depth_hi = hn::Set(d, edges.depth_hi);
        const V zero = hn::Zero(d);
        for (std::size_t slot = first; slot < last; slot += hn::Lanes(d)) {
            const V near = hn::LoadU(d, &tiles_.near[slot]);
            const V far = hn::LoadU(d, &tiles_.far[slot]);
            Mask possible = hn::And(hn::Ge(far, depth_lo), hn::Le(near, depth_hi));
            if (hn::AllFalse(d, possible)) continue;
            const V u = hn::LoadU(d, &tiles_.u[slot]);
            const V v = hn::LoadU(d, &tiles_.v[slot]);
            const auto edge = [&](std::size_t i) HWY_ATTR {
                return hn::MulAdd(
                    hn::Set(d, edges.u[i]),
                    u,
                    hn::MulAdd(hn::Set(d, edges.v[i]), v, hn::Set(d, edges.k[i]))
                );
            };
            const V e0 = edge(0);
            const V e1 = edge(1);
            const V e2 = edge(2);
            const V s0 = hn::Set(d, edges.sure[0]);
            const V s1 = hn::Set(d, edges.sure[1]);
            const V s2 = hn::Set(d, edges.sure[2]);
            Mask sure;
            if (edges.one_sided) {
                const Mask missed =
                    hn::Or(hn::Lt(e0, zero), hn::Or(hn::Lt(e1, zero), hn::Lt(e2, zero)));
                possible = hn::AndNot(missed, possible);
                if (hn::AllFalse(d, possible)) continue;
                sure = hn::And(hn::Gt(e0, s0), hn::And(hn::Gt(e1, s1), hn::Gt(e2, s2)));
            } else {
                const Mask above = hn::Or(hn::Gt(e0, s0), hn::Or(hn::Gt(e1, s1), hn::Gt(e2, s2)));
                const Mask below = hn::Or(
                    hn::Lt(e0, hn::Neg(s0)),
                    hn::Or(hn::Lt(e1, hn::Neg(s1)), hn::Lt(e2, hn::Neg(s2)))
                );
                possible = hn::AndNot(hn::And(above, below), possible);
                if (hn::AllFalse(d, possible)) continue;
                sure = hn::MaskFromVec(zero);
            }
            const auto ids = hn::Set(du, static_cast<std::uint32_t>(t.id));
            possible = hn::AndNot(
                hn::RebindMask(d, hn::Eq(hn::LoadU(du, &tiles_.excluded[slot]), ids)), possible
            );
            const V start = hn::Set(d, 16 * unit_roundoff * tile.scale);
            const V units = hn::Set(d, 16 * unit_roundoff);
            const V near_inside = hn::Add(near, hn::MulAdd(units, hn::Abs(near), start));
            const Mask known_near = hn::Eq(near, hn::Set(d, -infinity));
            V least = depth_lo;
            V most = depth_hi;
            if constexpr (is_closest) {
                if (edges.has_plane) plane_depth(t, edges, e0, e1, e2, least, most);
                possible = hn::And(possible, hn::And(hn::Le(least, far), hn::Ge(most, near)));
                if (hn::AllFalse(d, possible)) continue;
                const V after = hn::MulAdd(units, hn::Abs(most), hn::Add(start, most));
                const V before = hn::Sub(least, hn::MulAdd(units, hn::Abs(least), start));
                const V limit = hn::LoadU(d, &tiles_.least[slot]);
                sure = hn::And(hn::And(sure, possible), hn::Le(after, limit));
                sure = hn::And(sure, hn::Or(known_near, hn::Ge(least, near_inside)));
                if (!hn::AllFalse(d, sure)) {
                    hn::BlendedStore(after, sure, d, &tiles_.far[slot]);
                    hn::BlendedStore(before, sure, d, &tiles_.least[slot]);
                    hn::BlendedStore(ids, hn::RebindMask(du, sure), du, &tiles_.best[slot]);
                }
                for_lanes(hn::AndNot(sure, possible), [&](std::size_t lane) HWY_ATTR {
                    resolve(face, slot + lane, t.id);
                });
            } else {
                const V far_inside = hn::Sub(far, hn::MulAdd(units, hn::Abs(far), start));
                const Mask known_far = hn::Eq(far, hn::Set(d, infinity));
                const auto inside = [&]() HWY_ATTR {
                    return hn::And(
                        hn::Or(known_near, hn::Ge(least, near_inside)),
                        hn::Or(known_far, hn::Le(most, far_inside))
                    );
                };
                sure = hn::And(sure, possible);
                const Mask in = inside();
                if (edges.has_plane && !hn::AllFalse(d, hn::AndNot(in, possible))) {
                    plane_depth(t, edges, e0, e1, e2, least, most);
                    possible = hn::And(possible, hn::And(hn::Le(least, far), hn::Ge(most, near)));
                    sure = hn::And(hn::And(sure, possible), hn::Or(in, inside()));
                } else {
                    sure = hn::And(sure, in);
                }
                for_lanes(sure, [&](std::size_t lane) HWY_ATTR { set_hit(tile, slot + lane); });
                for_lanes(hn::AndNot(sure, possible), [&](std::size_t lane) HWY_ATTR {
                    const Ray& ray = raster_.rays[tiles_.index[slot + lane]];
                    if (ExactKernel::decide(ray, raster_.triangles[t.id], t.id, ray.t_max))
                        set_hit(tile, slot + lane);
                });
            }
        }
    }

    template <class Work>
    static void for_lanes(Mask mask, Work&& work) {
        const D d;
        if (hn::AllFalse(d, mask)) return;
        std::array<std::uint8_t, 8> bytes{};
        hn::StoreMaskBits(d, mask, bytes.data());
        auto bits = std::bit_cast<std::uint64_t>(bytes);
        for (; bits != 0; bits &= bits - 1)
            work(static_cast<std::size_t>(std::countr_zero(bits)));
    }

    void set_hit(Tile& tile, std::size_t slot) {
        raster_.hits[tiles_.index[slot]] = true;
        tiles_.near[slot] = infinity;
        tiles_.far[slot] = -infinity;
        tile.undecided.store(
            tile.undecided.load(std::memory_order_relaxed) - 1, std::memory_order_relaxed
        );
    }

    /// Asks a triangle and the best one so far exactly, and keeps the closer hit.
    void resolve(const Face& face, std::size_t slot, PrimId id) {
        const Ray& ray = raster_.rays[tiles_.index[slot]];
        const auto ask = [&](PrimId prim, float t_max) {
            return ExactKernel::decide(ray, raster_.triangles[prim], prim, t_max);
        };
        const PrimId old{tiles_.best[slot]};
        std::optional<Hit> best;
        if (old != no_prim) best = ask(old, ray.t_max);
        const std::optional<Hit> other = ask(id, best ? best->t : ray.t_max);
        if (other && (!best || is_closer(*other, *best))) best = other;
        if (!best) return;
        tiles_.best[slot] = static_cast<std::uint32_t>(best->prim);
        const FaceRay seen = face.ray(ray);
        const double depth = face.depth_at(ray, best->t);
        const double margin = 16 * 0x1p-24 * (std::abs(depth) + seen.scale);
        tiles_.far[slot] = std::min(tiles_.far[slot], static_cast<float>(depth + margin));
        tiles_.least[slot] = static_cast<float>(depth - margin);
    }

    /// A triangle that comes too near to the apex for any picture: every ray is asked.
    void ask_all(PrimId id) {
        const Triangle triangle = raster_.triangles[id];
        for (std::size_t f = 0; f < tiles_.faces.size(); ++f) {
            const Window& window = tiles_.windows[f];
            const std::size_t end = window.first_tile + window.columns * window.rows;
            for (std::size_t at = window.first_tile; at < end; ++at) {
                Tile& tile = tiles_.tiles[at];
                if (tile.undecided.load(std::memory_order_relaxed) == 0) continue;
                const TileLock lock(tile);
                for (std::size_t slot = tile.first; slot < tile.first + tile.count; ++slot) {
                    if (!(tiles_.near[slot] <= tiles_.far[slot])) continue;
                    const Ray& ray = raster_.rays[tiles_.index[slot]];
                    if (!ExactKernel(ray)(triangle, id, ray.t_max)) continue;
                    if constexpr (is_closest) {
                        resolve(tiles_.faces[f], slot, id);
                    } else {
                        set_hit(tile, slot);
                    }
                }
            }
        }
    }

    /// Keeps the undecided slots, in their bins.
    void drop_decided(Tile& tile) {
        std::uint32_t* const starts = &tiles_.bin_starts[tile.bins];
        const std::uint32_t bins = tile.columns * tile.rows;
        std::uint32_t to = 0;
        std::uint32_t from = 0;
        for (std::uint32_t bin = 0; bin < bins; ++bin) {
            const std::uint32_t end = starts[bin + 1];
            starts[bin] = to;
            for (; from < end; ++from) {
                const std::size_t a = tile.first + from;
                if (!(tiles_.near[a] <= tiles_.far[a])) continue;
                const std::size_t b = tile.first + to++;
                tiles_.u[b] = tiles_.u[a];
                tiles_.v[b] = tiles_.v[a];
                tiles_.near[b] = tiles_.near[a];
                tiles_.far[b] = tiles_.far[a];
                tiles_.excluded[b] = tiles_.excluded[a];
                tiles_.index[b] = tiles_.index[a];
            }
        }
        starts[bins] = to;
        // Vectors read on: what is left behind must not be asked again.
        for (std::uint32_t slot = to; slot < tile.count; ++slot) {
            tiles_.near[tile.first + slot] = infinity;
            tiles_.far[tile.first + slot] = -infinity;
        }
        tile.count = to;
    }

    static constexpr float infinity = std::numeric_limits<float>::infinity();

    const Raster& raster_;
    RayTiles& tiles_;
    double brink_ = 0;
    bool reversed_ = tiles_.faces[0].is_reversed();
};

template <bool is_radial, bool is_closest>
void draw_range(const Raster& raster, std::size_t first, std::size_t last) {
    Drawing<is_radial, is_closest> drawing(raster);
    for (std::size_t i = first; i < last; ++i)
        drawing.draw(to_prim(i));
}

void draw_triangles(const Raster& raster, std::size_t first, std::size_t last) {
    const bool is_radial = raster.pencil.kind() == Pencil::Kind::radial;
    if (raster.hits != nullptr) {
        is_radial ? draw_range<true, false>(raster, first, last)
                  : draw_range<false, false>(raster, first, last);
    } else {
        is_radial ? draw_range<true, true>(raster, first, last)
                  : draw_range<false, true>(raster, first, last);
    }
}

} // namespace HWY_NAMESPACE
} // namespace raywise::detail

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raywise::detail {

HWY_EXPORT(draw_triangles);

void draw(const Raster& raster, std::size_t first, std::size_t last) {
    HWY_DYNAMIC_DISPATCH(draw_triangles)(raster, first, last);
}

} // namespace raywise::detail

#endif
