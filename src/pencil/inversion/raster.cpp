// Triangles drawn over rays, several rays per operation. After [Aila04], [Johnson05].
//
// A triangle is drawn picture by picture, tile by tile, row of bins by row of bins; a row's part
// between the edges is one run of slots. Lanes answer "surely missed" or "surely hit, at a depth
// surely inside"; the rest is decided exactly. One file, because it is compiled once for each
// instruction set.

// The same instructions as a neighbor's, or no gain here: fewer copies of the code.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pencil/inversion/raster.cpp"
#include "pencil/inversion/drawn.hpp"
#include "pencil/inversion/edges.hpp"
#include "pencil/inversion/facing.hpp"
#include "pencil/inversion/raster.hpp"

#include <raywise/geometry/ray_triangle.hpp>

#include <hwy/cache_control.h>
#include <hwy/foreach_target.h> // first: includes this file once per instruction set
#include <hwy/highway.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>

HWY_BEFORE_NAMESPACE();

namespace raywise::detail {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Holds a tile against other threads.
class TileLock {
public:
    TileLock(Tile& tile, bool is_shared) : tile_(is_shared ? &tile : nullptr) {
        while (tile_ != nullptr && tile_->busy.exchange(true, std::memory_order_acquire))
            while (tile_->busy.load(std::memory_order_relaxed)) {
            }
    }
    ~TileLock() {
        if (tile_ != nullptr) tile_->busy.store(false, std::memory_order_release);
    }
    TileLock(const TileLock&) = delete;
    TileLock& operator=(const TileLock&) = delete;
    TileLock(TileLock&&) = delete;
    TileLock& operator=(TileLock&&) = delete;

private:
    Tile* tile_;
};

template <bool is_radial, bool is_closest>
class Drawing {
public:
    // NOLINTNEXTLINE(*-member-init): of the arrays, only what is counted is read
    explicit Drawing(const Raster& raster) : raster_(raster), tiles_(raster.tiles) {
        for (const Window& window : tiles_.windows) {
            brink_ = greater(brink_, window.brink);
            reach_ = greater(reach_, window.reach);
        }
    }

    /// Soon, or at the latest by `finish`.
    void draw(PrimId id) {
        const Triangle triangle = raster_.triangles[id];
        if (!is_finite(triangle)) return;
        if constexpr (is_radial) {
            const Around around = look_around(apex_, triangle);
            // Rays that end at the apex pass it by a rounding, rays that start there may hit what
            // touches it from any side: no picture shows that.
            if (around.distance <= brink_) {
                ask_all(id);
                return;
            }
            const double slack =
                0x1p-40 + 2.1 * 0x1p-24 * greater(1.0, 2 * reach_ / around.distance);
            for (std::size_t f = 0; f < tiles_.faces.size(); ++f) {
                const Window& window = tiles_.windows[f];
                if (window.is_empty() || !may_face(around, f, slack)) continue;
                Drawn& drawn = next_drawn(id, f, triangle);
                measure_depth(drawn);
                drawn.size = around.size;
                drawn.distance = around.distance;
                if (show_radial(drawn, window)) add_shots(drawn, f);
            }
        } else {
            const Window& window = tiles_.windows[0];
            if (window.is_empty()) return;
            Drawn& drawn = next_drawn(id, 0, triangle);
            measure_parallel(drawn);
            if (show_parallel(drawn, window, triangle)) add_shots(drawn, 0);
        }
    }

    void finish() {
        shoot_all();
        drawn_count_ = 0;
    }

private:
    using D = hn::ScalableTag<float>;
    using DU = hn::RebindToUnsigned<D>;
    using V = hn::Vec<D>;
    using Mask = hn::Mask<D>;

    /// Zero times a float is a number only when it is finite.
    static bool is_finite(const Triangle& t) {
        const auto& [a, b, c] = t;
        return 0 * a.x + 0 * a.y + 0 * a.z + 0 * b.x + 0 * b.y + 0 * b.z + 0 * c.x + 0 * c.y +
                   0 * c.z ==
               0;
    }

    Drawn& next_drawn(PrimId id, std::size_t face, const Triangle& triangle) {
        if (drawn_count_ == drawn_.size()) finish();
        Drawn& drawn = drawn_[drawn_count_];
        drawn.id = id;
        drawn.p[0] = tiles_.faces[face].point<is_radial>(triangle.v0);
        drawn.p[1] = tiles_.faces[face].point<is_radial>(triangle.v1);
        drawn.p[2] = tiles_.faces[face].point<is_radial>(triangle.v2);
        return drawn;
    }

    static bool is_beside(const Drawn& t, const Window& window) {
        return t.u_lo > window.u_hi || t.u_hi < window.u_lo || t.v_lo > window.v_hi ||
               t.v_hi < window.v_lo;
    }

    static void widen(Drawn& t, double slack) {
        t.u_lo -= slack;
        t.u_hi += slack;
        t.v_lo -= slack;
        t.v_hi += slack;
    }

    /// Whether the triangle may be seen in the window, and what is seen.
    bool show_parallel(Drawn& t, const Window& window, const Triangle& triangle) const {
        widen(t, 0x1p-48 * t.size);
        if (is_beside(t, window)) return false;
        t.u = {t.p[0].x, t.p[1].x, t.p[2].x};
        t.v = {t.p[0].y, t.p[1].y, t.p[2].y};
        t.is_flat = true;
        if (find_side(t, 0x1p-50 * t.size)) return true;
        // Seen edge-on it is never hit.
        const Vec3 direction = raster_.pencil.direction();
        const int sign = exact_facing(direction, triangle);
        t.side = direction[dominant_axis(direction)] < 0 ? -sign : sign;
        t.is_flat = false;
        return sign != 0;
    }

    bool show_radial(Drawn& t, const Window& window) const {
        const double aside = window.reach > 0 ? deviation(t, window.reach) : 0;
        const double slack = 0x1p-44 + aside;
        const auto& [a, b, c] = t.p;
        const auto beside = [&](auto&& outside) { return outside(a) && outside(b) && outside(c); };
        const double room = slack + 0x1p-40;
        const double noise = 0x1p-44 * t.size;
        if (beside([&](auto& p) { return p.x > (window.u_hi + room) * p.h + noise; }) ||
            beside([&](auto& p) { return (window.u_lo - room) * p.h > p.x + noise; }) ||
            beside([&](auto& p) { return p.y > (window.v_hi + room) * p.h + noise; }) ||
            beside([&](auto& p) { return (window.v_lo - room) * p.h > p.y + noise; }))
            return false;
        t.is_flat = false;
        t.side = 0;
        if (least_of(a.h, b.h, c.h) > 0x1p-20 * t.size) {
            const std::array<double, 3> inverse{1 / a.h, 1 / b.h, 1 / c.h};
            t.u = {a.x * inverse[0], b.x * inverse[1], c.x * inverse[2]};
            t.v = {a.y * inverse[0], b.y * inverse[1], c.y * inverse[2]};
            t.u_lo = least_of(t.u[0], t.u[1], t.u[2]);
            t.u_hi = greatest_of(t.u[0], t.u[1], t.u[2]);
            t.v_lo = least_of(t.v[0], t.v[1], t.v[2]);
            t.v_hi = greatest_of(t.v[0], t.v[1], t.v[2]);
            const double greatest = greater(greater(-t.u_lo, t.u_hi), greater(-t.v_lo, t.v_hi));
            t.is_flat = greatest < 64 && find_side(t, 0x1p-50 * greatest);
            widen(t, slack + 0x1p-48 * greatest);
            return !is_beside(t, window);
        }
        // It reaches behind.
        constexpr double everywhere = std::numeric_limits<double>::infinity();
        t.u_lo = t.v_lo = -everywhere;
        t.u_hi = t.v_hi = everywhere;
        return true;
    }

    static double aside_of(const Drawn& t, double reach) {
        if constexpr (is_radial) {
            if (reach > 0) return deviation(t, reach);
        }
        return 0;
    }

    /// What doubles are off on a tile, generously.
    static double noise_of(const Drawn& t, const Tile& tile) {
        if constexpr (is_radial) return 0x1p-42;
        return 0x1p-48 * (t.size + std::abs(tile.u) + std::abs(tile.v));
    }

    /// One tile that a triangle may be drawn on.
    struct Shot {
        const Drawn* drawn;
        Tile* tile;
        std::uint32_t face;
        std::uint32_t column_lo, column_hi, row_lo, row_hi; ///< bins
        Edges edges;
    };

    void add_shot(const Drawn& t, std::size_t face, Tile& tile) {
        if (shot_count_ == shots_.size()) shoot_all();
        hwy::Prefetch(&tile);
        hwy::Prefetch(reinterpret_cast<const std::byte*>(&tile) + 64);
        Shot& shot = shots_[shot_count_++];
        shot.drawn = &t;
        shot.tile = &tile;
        shot.face = static_cast<std::uint32_t>(face);
    }

    /// In three passes, so that the memory of each step is on its way while others are worked on.
    void shoot_all() {
        std::size_t count = 0;
        for (std::size_t i = 0; i < shot_count_; ++i) {
            Shot& shot = shots_[count];
            shot.drawn = shots_[i].drawn;
            shot.tile = shots_[i].tile;
            shot.face = shots_[i].face;
            if (!aim(shot)) continue;
            hwy::Prefetch(first_start(shot));
            ++count;
        }
        for (std::size_t i = 0; i < count; ++i) {
            const Tile& tile = *shots_[i].tile;
            std::size_t slot = tile.first;
            {
                const TileLock lock(*shots_[i].tile, raster_.is_shared);
                slot += *first_start(shots_[i]);
            }
            hwy::Prefetch(&tiles_.near[slot]);
            hwy::Prefetch(&tiles_.far[slot]);
            hwy::Prefetch(&tiles_.u[slot]);
            hwy::Prefetch(&tiles_.v[slot]);
        }
        for (std::size_t i = 0; i < count; ++i)
            shoot(shots_[i]);
        shot_count_ = 0;
    }

    [[nodiscard]] const std::uint32_t* first_start(const Shot& shot) const {
        const Tile& tile = *shot.tile;
        return &tiles_.bin_starts[tile.bins + shot.row_lo * tile.columns + shot.column_lo];
    }

    /// Shots on all tiles that the last triangle drawn may meet.
    void add_shots(const Drawn& t, std::size_t face) {
        ++drawn_count_;
        const Window& window = tiles_.windows[face];
        const std::uint32_t column_lo = window.column(t.u_lo), column_hi = window.column(t.u_hi);
        const std::uint32_t row_lo = window.row(t.v_lo), row_hi = window.row(t.v_hi);
        Tile* const tiles = tiles_.tiles.data() + window.first_tile;
        if (column_hi - column_lo < 2 || row_lo == row_hi) {
            for (std::uint32_t row = row_lo; row <= row_hi; ++row)
                for (std::uint32_t column = column_lo; column <= column_hi; ++column)
                    add_shot(t, face, tiles[row * window.columns + column]);
            return;
        }
        // Long in both directions: walk the rows between the edges.
        Tile whole;
        whole.u = (window.u_lo + window.u_hi) / 2;
        whole.v = (window.v_lo + window.v_hi) / 2;
        whole.half_u = static_cast<float>((window.u_hi - window.u_lo) * 0.50001);
        whole.half_v = static_cast<float>((window.v_hi - window.v_lo) * 0.50001);
        Edges edges; // NOLINT(*-member-init)
        make_edges<is_radial>(edges, t, whole, aside_of(t, window.reach));
        const RowClipper clip(edges);
        const double extra = 0x1p-18 * static_cast<double>(whole.half_v);
        const double room = 0x1p-18 * static_cast<double>(whole.half_u);
        for (std::uint32_t row = row_lo; row <= row_hi; ++row) {
            double lo = window.v_lo;
            double hi = window.v_hi;
            if (row > 0) lo = window.v + row / window.per_v - extra;
            if (row + 1 < window.rows) hi = window.v + (row + 1) / window.per_v + extra;
            const auto below = static_cast<float>(lo - whole.v);
            const auto above = static_cast<float>(hi - whole.v);
            float from = -whole.half_u, to = whole.half_u;
            if (!clip(below, above, from, to)) continue;
            const std::uint32_t first =
                greater(column_lo, window.column(whole.u + static_cast<double>(from) - room));
            const std::uint32_t last =
                lesser(column_hi, window.column(whole.u + static_cast<double>(to) + room));
            for (std::uint32_t column = first; column <= last; ++column)
                add_shot(t, face, tiles[row * window.columns + column]);
        }
    }

    /// The edges and bins of a shot; false: it meets no ray.
    static bool aim(Shot& shot) {
        const Drawn& t = *shot.drawn;
        const Tile& tile = *shot.tile;
        if (tile.undecided.load(std::memory_order_relaxed) == 0) return false;
        // Outward, so that rounding never skips a tile.
        if (t.depth_lo * (1 + std::copysign(0x1p-22, -t.depth_lo)) >
                static_cast<double>(tile.far.load(std::memory_order_relaxed)) ||
            t.depth_hi * (1 + std::copysign(0x1p-22, t.depth_hi)) <
                static_cast<double>(tile.near.load(std::memory_order_relaxed)))
            return false;
        const double aside = aside_of(t, static_cast<double>(tile.start));
        if (t.is_flat) {
            const FlatCorners corners = flat_corners(t, tile);
            const auto noise = static_cast<float>(noise_of(t, tile)) * 1.0001F;
            const auto off = static_cast<float>(aside) * 1.0001F;
            const float room = 4 * 0x1p-24F * (corners.greatest + tile.half_u + tile.half_v) +
                               noise + off + 0x1p-140F;
            const float x_lo = corners.x_lo - room;
            const float x_hi = corners.x_hi + room;
            const float y_lo = corners.y_lo - room;
            const float y_hi = corners.y_hi + room;
            if (x_lo > tile.half_u || x_hi < -tile.half_u || y_lo > tile.half_v ||
                y_hi < -tile.half_v)
                return false;
            if (make_flat_edges(shot.edges, t, tile, corners, noise, off)) {
                shot.column_lo = tile.column(x_lo);
                shot.column_hi = tile.column(x_hi);
                shot.row_lo = tile.row(y_lo);
                shot.row_hi = tile.row(y_hi);
                return true;
            }
        }
        const auto half_u = static_cast<double>(tile.half_u);
        const auto half_v = static_cast<double>(tile.half_v);
        const double u_lo = t.u_lo - tile.u - 8 * 0x1p-24 * half_u - 0x1p-148;
        const double u_hi = t.u_hi - tile.u + 8 * 0x1p-24 * half_u + 0x1p-148;
        const double v_lo = t.v_lo - tile.v - 8 * 0x1p-24 * half_v - 0x1p-148;
        const double v_hi = t.v_hi - tile.v + 8 * 0x1p-24 * half_v + 0x1p-148;
        if (u_lo > half_u || u_hi < -half_u || v_lo > half_v || v_hi < -half_v) return false;
        const auto clamped = [](double at, double half) {
            return static_cast<float>(std::clamp(at, -half, half));
        };
        shot.column_lo = tile.column(clamped(u_lo, half_u));
        shot.column_hi = tile.column(clamped(u_hi, half_u));
        shot.row_lo = tile.row(clamped(v_lo, half_v));
        shot.row_hi = tile.row(clamped(v_hi, half_v));
        make_edges<is_radial>(shot.edges, t, tile, aside);
        return true;
    }

    void shoot(const Shot& shot) {
        const Drawn& t = *shot.drawn;
        const Edges& edges = shot.edges;
        const Face& face = tiles_.faces[shot.face];
        Tile& tile = *shot.tile;
        const std::uint32_t column_lo = shot.column_lo, column_hi = shot.column_hi;
        const std::uint32_t row_lo = shot.row_lo, row_hi = shot.row_hi;
        const TileLock lock(tile, raster_.is_shared);
        const std::uint32_t* const starts = &tiles_.bin_starts[tile.bins];
        const auto draw_row = [&](std::uint32_t row, std::uint32_t first, std::uint32_t last
                              ) HWY_ATTR {
            const std::uint32_t* const row_starts = starts + row * tile.columns;
            draw_run(
                t,
                edges,
                face,
                tile,
                tile.first + row_starts[first],
                tile.first + row_starts[last + 1]
            );
        };
        if (column_hi - column_lo < 2 || row_lo == row_hi) {
            for (std::uint32_t row = row_lo; row <= row_hi; ++row)
                draw_row(row, column_lo, column_hi);
        } else {
            const RowClipper clip(edges);
            const float extra = 0x1p-20F * tile.half_v;
            const float room = 0x1p-18F * tile.half_u;
            const float per_row = tile.per_v > 0 ? 1 / tile.per_v : 0;
            for (std::uint32_t row = row_lo; row <= row_hi; ++row) {
                float lo = -tile.half_v, hi = tile.half_v;
                if (row > 0) lo = tile.v0 + static_cast<float>(row) * per_row - extra;
                if (row + 1 < tile.rows)
                    hi = tile.v0 + static_cast<float>(row + 1) * per_row + extra;
                float from = -tile.half_u, to = tile.half_u;
                if (!clip(lo, hi, from, to)) continue;
                const std::uint32_t first = greater(column_lo, tile.column(from - room));
                const std::uint32_t last = lesser(column_hi, tile.column(to + room));
                if (first <= last) draw_row(row, first, last);
            }
        }
        const std::uint32_t undecided = tile.undecided.load(std::memory_order_relaxed);
        if (undecided * 2 < tile.count && tile.count > 32) drop_decided(tile);
    }

    /// Bounds of the depths at which the lanes' rays meet the plane, where they may hit.
    void
    plane_depth(const Drawn& t, const Edges& edges, V e0, V e1, V e2, V& least, V& most) const {
        const D d;
        const auto bound = static_cast<double>(edges.bound);
        if constexpr (is_radial) {
            // Depth is top / bottom; both are raised.
            V top_lo, top_hi, bottom_lo, bottom_hi;
            const V sum = hn::Add(hn::Add(e0, e1), e2);
            float unsure = 0x1p-17F;
            if (edges.is_flat) {
                const std::array<double, 3> inverse{1 / t.p[0].h, 1 / t.p[1].h, 1 / t.p[2].h};
                const auto part = [&](V e, std::size_t i) HWY_ATTR {
                    return hn::Mul(e, hn::Set(d, static_cast<float>(inverse[i])));
                };
                top_hi = sum;
                top_lo = hn::Sub(sum, hn::Set(d, static_cast<float>(6.1 * bound)));
                bottom_hi = hn::Add(hn::Add(part(e0, 0), part(e1, 1)), part(e2, 2));
                bottom_lo = hn::Sub(
                    bottom_hi,
                    hn::Set(
                        d, static_cast<float>(2.1 * bound * (inverse[0] + inverse[1] + inverse[2]))
                    )
                );
            } else {
                top_lo = top_hi = hn::Set(d, static_cast<float>(edges.volume));
                bottom_hi = sum;
                bottom_lo = hn::Sub(sum, hn::Set(d, static_cast<float>(6.1 * bound)));
                unsure += static_cast<float>(edges.volume_error * 1.01);
            }
            const V nearest = hn::Mul(hn::Div(top_lo, bottom_hi), hn::Set(d, 1 - unsure));
            const V farthest = hn::Mul(hn::Div(top_hi, bottom_lo), hn::Set(d, 1 + unsure));
            // Rounding the differences above is relative to what they were taken from.
            const Mask is_bounded = hn::Gt(bottom_lo, hn::Mul(bottom_hi, hn::Set(d, 0x1p-4F)));
            const Mask is_positive = hn::Gt(top_lo, hn::Mul(top_hi, hn::Set(d, 0x1p-4F)));
            least = hn::IfThenElseZero(is_positive, nearest);
            most = hn::IfThenElse(is_bounded, farthest, hn::Set(d, infinity));
            if (reversed_) {
                const V nearer = least;
                least = hn::Neg(most);
                most = hn::Neg(nearer);
            }
        } else {
            const double area = edges.is_flat ? std::abs(t.area) : edges.volume;
            const double inverse = 1 / area;
            const double b = t.p[1].depth - t.p[0].depth;
            const double c = t.p[2].depth - t.p[0].depth;
            const double change = std::abs(b) + std::abs(c);
            // find_side knows the area of a flat one to 2^-2 at worst: by its own bound.
            const double unsure = edges.is_flat ? t.area_error : edges.volume_error;
            const auto error = static_cast<float>(
                change * (2 * bound * inverse + 16 * 0x1p-24) * (1 + 2 * unsure) +
                change * 1.01 * unsure + 0x1p-22 * std::abs(t.p[0].depth) + 0x1p-48 * t.size +
                0x1p-145
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
            const V bar = hn::Set(d, edges.sure);
            const V lowest = hn::Min(e0, hn::Min(e1, e2));
            Mask sure;
            if (edges.one_sided) {
                possible = hn::And(possible, hn::Ge(lowest, zero));
                if (hn::AllFalse(d, possible)) continue;
                sure = hn::Gt(lowest, bar);
            } else {
                const V highest = hn::Max(e0, hn::Max(e1, e2));
                const Mask missed = hn::And(hn::Gt(highest, bar), hn::Lt(lowest, hn::Neg(bar)));
                possible = hn::AndNot(missed, possible);
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
        const bool leaves = !is_radial || ray.origin == raster_.pencil.apex();
        const FaceRay seen = face.ray<is_radial>(ray, leaves);
        const double depth = face.depth_at(ray, best->t);
        const double margin = 16 * 0x1p-24 * (std::abs(depth) + std::abs(seen.start) + seen.tiny);
        tiles_.far[slot] = lesser(tiles_.far[slot], static_cast<float>(depth + margin));
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
                const TileLock lock(tile, raster_.is_shared);
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
        float near = infinity;
        float far = -infinity;
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
                near = lesser(near, tiles_.near[b]);
                far = greater(far, tiles_.far[b]);
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
        tile.near.store(near, std::memory_order_relaxed);
        tile.far.store(far, std::memory_order_relaxed);
    }

    static constexpr float infinity = std::numeric_limits<float>::infinity();

    const Raster& raster_;
    RayTiles& tiles_;
    std::array<Drawn, 32> drawn_;
    std::array<Shot, 64> shots_;
    std::size_t drawn_count_ = 0;
    std::size_t shot_count_ = 0;
    Vec3d apex_ = is_radial ? to_double(raster_.pencil.apex()) : Vec3d{};
    double brink_ = 0;
    double reach_ = 0;
    bool reversed_ = tiles_.faces[0].is_reversed();
};

template <bool is_radial, bool is_closest>
void draw_range(const Raster& raster, std::size_t first, std::size_t last) {
    Drawing<is_radial, is_closest> drawing(raster);
    for (std::size_t i = first; i < last; ++i)
        drawing.draw(to_prim(i));
    drawing.finish();
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
