#include "pencil/inversion/extremes.hpp"
#include "pencil/inversion/face.hpp"
#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/core/ids.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise::detail {

namespace {

constexpr std::size_t rays_per_tile = 1024;
constexpr std::size_t rays_per_bin = 16;
constexpr std::size_t sample_size = 1024;
constexpr std::uint32_t no_tile = 0xFFFFFFFU;

/// A ray on its way from the batch to its slot.
struct SeenRay {
    float u, v, near, far, start;
    std::uint32_t excluded, index;
};

/// The faces of a pencil, coordinates of a parallel one about the first ray.
std::vector<Face> make_faces(const Pencil& pencil, std::span<const Ray> rays, bool reversed) {
    std::vector<Face> faces;
    if (pencil.kind() == Pencil::Kind::parallel) {
        Vec3 origin;
        for (const Ray& ray : rays)
            if (is_valid(ray)) {
                origin = ray.origin;
                break;
            }
        faces.push_back(Face::parallel(pencil.direction(), origin, reversed));
    } else {
        for (int i = 0; i < 6; ++i)
            faces.push_back(Face::radial(pencil.apex(), i, reversed));
    }
    return faces;
}

/// Which way a ray runs: away from the emitter or toward it; nowhere: it can hit nothing. Throws
/// Error when the pencil does not hold it.
class RunningOf {
public:
    explicit RunningOf(const Pencil& pencil)
        : value_(pencil.kind() == Pencil::Kind::parallel ? pencil.direction() : pencil.apex()) {}

    template <bool is_radial>
    [[nodiscard]] Running operator()(const Ray& ray) const {
        if (!is_finite(ray.origin) || !(ray.t_min >= 0 && ray.t_min <= ray.t_max) ||
            std::isinf(ray.t_min))
            return Running::nowhere;
        if constexpr (is_radial) {
            const bool at_apex = ray.origin == value_;
            if (at_apex && is_finite(ray.direction) && ray.direction != Vec3{})
                return Running::leaving;
            if (!at_apex && ray.direction == value_ - ray.origin && ray.t_max <= 1 &&
                is_finite(ray.direction))
                return Running::arriving;
        } else {
            if (ray.direction == -value_) return Running::arriving;
            if (ray.direction == value_) return Running::leaving;
        }
        if (is_valid(ray)) throw Error("inversion: a ray is not one of the pencil's");
        return Running::nowhere;
    }

private:
    Vec3 value_; ///< direction or apex
};

/// The middle of sorted values, with room around.
void set_range(std::vector<double>& values, double& lower, double& extent) {
    std::sort(values.begin(), values.end());
    const std::size_t rest = values.size() / 128;
    lower = values[rest];
    extent = values[values.size() - 1 - rest] - lower;
    lower -= extent / 32;
    extent += extent / 16;
}

/// Windows and tiles from a sample of the rays: the few rays far outside of the others go to the
/// outermost tiles.
template <bool is_radial>
std::vector<Window>
make_windows(const Pencil& pencil, const std::vector<Face>& faces, std::span<const Ray> rays) {
    struct Sample {
        std::vector<double> u, v;
    };

    const RunningOf running_of(pencil);
    std::vector<Sample> samples(faces.size());
    const std::size_t step = rays.size() / sample_size + 1;
    std::size_t total = 0;
    for (std::size_t i = 0; i < rays.size(); i += step) {
        const Running running = running_of.template operator()<is_radial>(rays[i]);
        if (running == Running::nowhere) continue;
        const bool leaves = running == Running::leaving;
        const std::size_t f = is_radial ? Face::index_of(pencil.apex(), rays[i], leaves) : 0;
        const FaceRay ray = faces[f].ray<is_radial>(rays[i], leaves);
        samples[f].u.push_back(ray.u);
        samples[f].v.push_back(ray.v);
        ++total;
    }
    std::vector<Window> windows(faces.size());
    std::uint32_t tiles = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        Window& window = windows[f];
        window.first_tile = tiles;
        if (const std::size_t n = samples[f].u.size(); n > 0) {
            double extent_u = 0;
            double extent_v = 0;
            set_range(samples[f].u, window.u, extent_u);
            set_range(samples[f].v, window.v, extent_v);
            const double wanted = greater(
                1.0,
                static_cast<double>(rays.size()) * static_cast<double>(n) /
                    static_cast<double>(total * rays_per_tile)
            );
            const double aspect = extent_u > 0 && extent_v > 0 ? extent_u / extent_v : 1;
            const double columns = std::clamp(std::sqrt(wanted * aspect), 1.0, wanted);
            window.columns = static_cast<std::uint32_t>(columns);
            window.rows = static_cast<std::uint32_t>(greater(1.0, wanted / columns));
            window.per_u = extent_u > 0 ? window.columns / extent_u : 0;
            window.per_v = extent_v > 0 ? window.rows / extent_v : 0;
        }
        tiles += window.columns * window.rows;
    }
    return windows;
}

/// Sorts the rays of one tile into rows of bins.
void sort_tile(RayTiles& to, Tile& tile, std::span<const SeenRay> rays, float tiny, bool closest) {
    tile.count = static_cast<std::uint32_t>(rays.size());
    tile.undecided.store(tile.count, std::memory_order_relaxed);
    float u_lo = infinity, u_hi = -infinity, v_lo = infinity, v_hi = -infinity;
    float near = infinity, far = -infinity;
    for (const SeenRay& ray : rays) {
        u_lo = lesser(u_lo, ray.u);
        u_hi = greater(u_hi, ray.u);
        v_lo = lesser(v_lo, ray.v);
        v_hi = greater(v_hi, ray.v);
        near = lesser(near, ray.near);
        far = greater(far, ray.far);
        tile.start = greater(tile.start, ray.start);
    }
    tile.near.store(near, std::memory_order_relaxed);
    tile.far.store(far, std::memory_order_relaxed);
    tile.scale = tile.start + tiny;
    if (!rays.empty()) {
        tile.half_u = greater(-u_lo, u_hi);
        tile.half_v = greater(-v_lo, v_hi);
        tile.u0 = u_lo;
        tile.v0 = v_lo;
        const double extent_u = static_cast<double>(u_hi) - static_cast<double>(u_lo);
        const double extent_v = static_cast<double>(v_hi) - static_cast<double>(v_lo);
        const double wanted =
            greater(1.0, static_cast<double>(rays.size()) / static_cast<double>(rays_per_bin));
        const double aspect = extent_u > 0 && extent_v > 0 ? extent_u / extent_v : 1;
        const double columns = std::clamp(std::sqrt(wanted * aspect), 1.0, wanted);
        tile.columns = static_cast<std::uint32_t>(columns);
        tile.rows = static_cast<std::uint32_t>(greater(1.0, wanted / columns));
        const auto per = [](double count, double extent) {
            const auto p = static_cast<float>(count / extent);
            return extent > 0 && std::isfinite(p) ? p : 0.0F;
        };
        tile.per_u = per(tile.columns, extent_u);
        tile.per_v = per(tile.rows, extent_v);
    }
    const std::uint32_t bins = tile.columns * tile.rows;
    std::uint32_t* const starts = &to.bin_starts[tile.bins];
    std::fill_n(starts, bins + 1, 0U);
    const auto bin_of = [&](const SeenRay& ray) {
        return tile.row(ray.v) * tile.columns + tile.column(ray.u);
    };
    for (const SeenRay& ray : rays)
        ++starts[bin_of(ray)];
    std::uint32_t sum = 0;
    for (std::uint32_t b = 0; b <= bins; ++b)
        starts[b] = sum += starts[b];
    for (std::size_t i = rays.size(); i-- > 0;) {
        const SeenRay& ray = rays[i];
        const std::size_t slot = tile.first + --starts[bin_of(ray)];
        to.u[slot] = ray.u;
        to.v[slot] = ray.v;
        to.near[slot] = ray.near;
        to.far[slot] = ray.far;
        to.excluded[slot] = ray.excluded;
        to.index[slot] = ray.index;
        if (closest) {
            to.least[slot] = ray.far - 16 * unit_roundoff * (std::abs(ray.far) + tile.scale);
            // A far end at infinity: every finite depth is before it.
            if (std::isinf(ray.far)) to.least[slot] = ray.far;
            to.best[slot] = static_cast<std::uint32_t>(no_prim);
        }
    }
    const std::size_t end = tile.first + padded_slots(tile.count);
    for (std::size_t slot = tile.first + tile.count; slot < end; ++slot) {
        to.u[slot] = to.v[slot] = 0;
        to.near[slot] = infinity;
        to.far[slot] = -infinity;
        to.excluded[slot] = to.index[slot] = 0;
        if (closest) to.least[slot] = -infinity;
    }
}

std::size_t most_tiles(std::size_t rays) {
    return rays / rays_per_tile + 6;
}

std::size_t most_slots(std::size_t rays) {
    return rays + std::size_t{2} * tile_alignment * most_tiles(rays);
}

std::size_t most_bin_starts(std::size_t rays) {
    return rays / rays_per_bin + 2 * most_tiles(rays);
}

} // namespace

RayTiles::RayTiles(
    const Pencil& pencil,
    std::span<const Ray> rays,
    RaysAsked asked,
    const Executor& executor
)
    : faces(make_faces(pencil, rays, asked == RaysAsked::arriving))
    , windows(
          pencil.kind() == Pencil::Kind::radial ? make_windows<true>(pencil, faces, rays)
                                                : make_windows<false>(pencil, faces, rays)
      )
    , tiles(windows.back().first_tile + windows.back().columns * windows.back().rows)
    , u(most_slots(rays.size()))
    , v(most_slots(rays.size()))
    , near(most_slots(rays.size()))
    , far(most_slots(rays.size()))
    , excluded(most_slots(rays.size()))
    , index(most_slots(rays.size()))
    , least(asked == RaysAsked::all ? 0 : most_slots(rays.size()))
    , best(asked == RaysAsked::all ? 0 : most_slots(rays.size()))
    , bin_starts(most_bin_starts(rays.size())) {
    if (pencil.kind() == Pencil::Kind::radial) {
        sort<true>(pencil, rays, asked, executor);
    } else {
        sort<false>(pencil, rays, asked, executor);
    }
}

template <bool is_radial>
void RayTiles::sort(
    const Pencil& pencil,
    std::span<const Ray> rays,
    RaysAsked asked,
    const Executor& executor
) {
    const RunningOf running_of(pencil);
    const LargeBuffer<Placed> places(rays.size());
    // At most 32 chunks, so that their counts stay few.
    const auto chunk = greater<std::size_t>(16384, rays.size() / 32 + 1);
    std::vector<Share> shares((rays.size() + chunk - 1) / chunk);
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        Share& share = shares[begin / chunk];
        share.starts.assign(tiles.size(), 0);
        share.windows.resize(windows.size());
        for (std::size_t i = begin; i < end; ++i) {
            const Running running = running_of.template operator()<is_radial>(rays[i]);
            const bool leaves = running == Running::leaving;
            places[i] = {no_tile, 0, leaves ? 1U : 0U};
            if (running == Running::nowhere) continue;
            if (asked != RaysAsked::all && leaves != (asked == RaysAsked::leaving)) {
                ++share.skipped;
                continue;
            }
            ++share.seen;
            const std::size_t f = is_radial ? Face::index_of(pencil.apex(), rays[i], leaves) : 0;
            const FaceRay ray = faces[f].ray<is_radial>(rays[i], leaves);
            const Window& window = windows[f];
            const std::uint32_t tile =
                window.first_tile + window.row(ray.v) * window.columns + window.column(ray.u);
            places[i] = {tile & no_tile, static_cast<std::uint32_t>(f) & 7U, leaves ? 1U : 0U};
            ++share.starts[tile];
            share.windows[f].include(ray);
        }
    });
    const std::vector<std::uint32_t> firsts = lay_out(shares);
    double tiny = 0;
    for (const Window& window : windows)
        tiny = greater(tiny, window.tiny * (1 + 0x1p-22));

    const LargeBuffer<SeenRay> sorted(firsts.back());
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t>& starts = shares[begin / chunk].starts;
        for (std::size_t i = begin; i < end; ++i) {
            const Placed place = places[i];
            if (place.tile == no_tile) continue;
            const FaceRay ray = faces[place.face].ray<is_radial>(rays[i], place.leaves != 0);
            const Tile& tile = tiles[place.tile];
            // Outward, by more than roundings of the depths and of t come to.
            const auto margin = [&](double end_depth) {
                return 4 * 0x1p-24 * (std::abs(end_depth) + std::abs(ray.start) + ray.tiny);
            };
            sorted[starts[place.tile]++] = {
                static_cast<float>(ray.u - tile.u),
                static_cast<float>(ray.v - tile.v),
                static_cast<float>(ray.near - margin(ray.near)),
                static_cast<float>(ray.far + margin(ray.far)),
                static_cast<float>(std::abs(ray.start) * (1 + 0x1p-22)),
                static_cast<std::uint32_t>(rays[i].excluded),
                static_cast<std::uint32_t>(i)
            };
        }
    });
    executor.for_each_chunk(tiles.size(), 16, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
            sort_tile(
                *this,
                tiles[t],
                {sorted.get() + firsts[t], firsts[t + 1] - firsts[t]},
                static_cast<float>(tiny),
                asked != RaysAsked::all
            );
    });
}

std::vector<std::uint32_t> RayTiles::lay_out(std::vector<Share>& shares) {
    for (const Share& share : shares) {
        seen += share.seen;
        skipped += share.skipped;
        for (std::size_t f = 0; f < windows.size(); ++f)
            windows[f].include(share.windows[f]);
    }
    std::vector<std::uint32_t> firsts(tiles.size() + 1);
    std::uint32_t sum = 0;
    std::uint32_t slots = 0;
    std::uint32_t bins = 0;
    for (std::size_t t = 0; t < tiles.size(); ++t) {
        firsts[t] = sum;
        for (Share& share : shares) {
            const std::uint32_t count = share.starts[t];
            share.starts[t] = sum;
            sum += count;
        }
        const std::uint32_t count = sum - firsts[t];
        tiles[t].first = slots;
        tiles[t].bins = bins;
        slots += padded_slots(count);
        bins += static_cast<std::uint32_t>(count / rays_per_bin) + 2;
    }
    firsts.back() = sum;
    for (const Window& window : windows)
        for (std::uint32_t row = 0; row < window.rows; ++row)
            for (std::uint32_t column = 0; column < window.columns; ++column) {
                Tile& tile = tiles[window.first_tile + row * window.columns + column];
                tile.u = window.u + (window.per_u > 0 ? (column + 0.5) / window.per_u : 0);
                tile.v = window.v + (window.per_v > 0 ? (row + 0.5) / window.per_v : 0);
            }
    return firsts;
}

std::size_t RayTiles::most_bytes(std::size_t rays) {
    return rays * (sizeof(RayTiles::Placed) + sizeof(SeenRay)) +
           most_slots(rays) * (6 + 2) * sizeof(float) +
           most_bin_starts(rays) * sizeof(std::uint32_t) +
           most_tiles(rays) * (sizeof(Tile) + 33 * sizeof(std::uint32_t));
}

} // namespace raywise::detail
