#include "pencil/inversion/ray_tiles.hpp"

#include <raywise/core/error.hpp>

#include <array>
#include <cmath>
#include <memory>

namespace raywise::detail {

namespace {

constexpr std::size_t rays_per_tile = 512;
constexpr std::size_t rays_per_bin = 8;
constexpr std::size_t sample_size = 1024;
constexpr std::uint32_t no_tile = 0xFFFFFFFFU;
constexpr float infinity = std::numeric_limits<float>::infinity();

/// A ray on its way from the batch to its slot.
struct SeenRay {
    float u, v, near, far, scale, start;
    std::uint32_t excluded, index;
};

bool is_asked(const FaceRay& ray, RaysAsked asked) {
    return asked == RaysAsked::all || ray.leaves == (asked == RaysAsked::leaving);
}

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

struct Placed {
    std::size_t face;
    FaceRay ray;
};

/// Where a ray is seen; nothing for a ray that can hit nothing.
bool place(const Pencil& pencil, const std::vector<Face>& faces, const Ray& ray, Placed& placed) {
    if (!is_valid(ray) || std::isinf(ray.t_min)) return false;
    placed.face = 0;
    if (pencil.kind() == Pencil::Kind::radial)
        placed.face = static_cast<std::size_t>(Face::index_of(pencil.apex(), ray));
    placed.ray = faces[placed.face].ray(ray);
    return true;
}

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
std::vector<Window>
make_windows(const Pencil& pencil, const std::vector<Face>& faces, std::span<const Ray> rays) {
    struct Sample {
        std::vector<double> u, v;
    };

    std::vector<Sample> samples(faces.size());
    const std::size_t step = rays.size() / sample_size + 1;
    std::size_t total = 0;
    for (std::size_t i = 0; i < rays.size(); i += step) {
        Placed placed{};
        if (!place(pencil, faces, rays[i], placed)) continue;
        if (!std::isfinite(placed.ray.u) || !std::isfinite(placed.ray.v)) continue;
        samples[placed.face].u.push_back(placed.ray.u);
        samples[placed.face].v.push_back(placed.ray.v);
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
            const double wanted = std::max(
                1.0,
                static_cast<double>(rays.size()) * static_cast<double>(n) /
                    static_cast<double>(total * rays_per_tile)
            );
            const double aspect = extent_u > 0 && extent_v > 0 ? extent_u / extent_v : 1;
            const double columns = std::clamp(std::sqrt(wanted * aspect), 1.0, wanted);
            window.columns = static_cast<std::uint32_t>(columns);
            window.rows = static_cast<std::uint32_t>(std::max(1.0, wanted / columns));
            window.per_u = extent_u > 0 ? window.columns / extent_u : 0;
            window.per_v = extent_v > 0 ? window.rows / extent_v : 0;
        }
        tiles += window.columns * window.rows;
    }
    return windows;
}

/// Sorts the rays of one tile into rows of bins.
void sort_tile(RayTiles& to, Tile& tile, std::span<SeenRay> rays, bool closest) {
    tile.count = static_cast<std::uint32_t>(rays.size());
    tile.undecided.store(tile.count, std::memory_order_relaxed);
    float u_lo = infinity, u_hi = -infinity, v_lo = infinity, v_hi = -infinity;
    for (const SeenRay& ray : rays) {
        u_lo = std::min(u_lo, ray.u);
        u_hi = std::max(u_hi, ray.u);
        v_lo = std::min(v_lo, ray.v);
        v_hi = std::max(v_hi, ray.v);
        tile.near = std::min(tile.near, ray.near);
        tile.far = std::max(tile.far, ray.far);
        tile.scale = std::max(tile.scale, ray.scale);
        tile.start = std::max(tile.start, ray.start);
    }
    if (!rays.empty()) {
        tile.half_u = std::max(-u_lo, u_hi);
        tile.half_v = std::max(-v_lo, v_hi);
        tile.u0 = u_lo;
        tile.v0 = v_lo;
        const double extent_u = static_cast<double>(u_hi) - static_cast<double>(u_lo);
        const double extent_v = static_cast<double>(v_hi) - static_cast<double>(v_lo);
        const double wanted =
            std::max(1.0, static_cast<double>(rays.size()) / static_cast<double>(rays_per_bin));
        const double aspect = extent_u > 0 && extent_v > 0 ? extent_u / extent_v : 1;
        const double columns = std::clamp(std::sqrt(wanted * aspect), 1.0, wanted);
        tile.columns = static_cast<std::uint32_t>(columns);
        tile.rows = static_cast<std::uint32_t>(std::max(1.0, wanted / columns));
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
            to.least[slot] = ray.far - 16 * unit_roundoff * (std::abs(ray.far) + ray.scale);
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
    return rays + 2 * tile_alignment * most_tiles(rays);
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
    , windows(make_windows(pencil, faces, rays))
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
    const LargeBuffer<std::uint32_t> tile_of(rays.size());
    // At most 32 chunks, so that their counts stay few.
    const std::size_t chunk = std::max<std::size_t>(16384, rays.size() / 32 + 1);
    const std::size_t chunks = (rays.size() + chunk - 1) / chunk;

    struct Share {
        std::vector<std::uint32_t> starts;
        std::vector<Window> windows;
        std::size_t seen = 0;
        std::size_t skipped = 0;
    };

    std::vector<Share> shares(chunks);
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        Share& share = shares[begin / chunk];
        share.starts.assign(tiles.size(), 0);
        share.windows.resize(windows.size());
        for (std::size_t i = begin; i < end; ++i) {
            Placed placed{};
            tile_of[i] = no_tile;
            if (!place(pencil, faces, rays[i], placed)) continue;
            if (!pencil.holds(rays[i])) throw Error("inversion: a ray is not one of the pencil's");
            if (!is_asked(placed.ray, asked)) {
                ++share.skipped;
                continue;
            }
            ++share.seen;
            const Window& window = windows[placed.face];
            tile_of[i] = window.first_tile + window.row(placed.ray.v) * window.columns +
                         window.column(placed.ray.u);
            ++share.starts[tile_of[i]];
            share.windows[placed.face].include(placed.ray);
        }
    });

    for (const Share& share : shares) {
        seen += share.seen;
        skipped += share.skipped;
        for (std::size_t f = 0; f < windows.size(); ++f) {
            const Window& part = share.windows[f];
            windows[f].u_lo = std::min(windows[f].u_lo, part.u_lo);
            windows[f].u_hi = std::max(windows[f].u_hi, part.u_hi);
            windows[f].v_lo = std::min(windows[f].v_lo, part.v_lo);
            windows[f].v_hi = std::max(windows[f].v_hi, part.v_hi);
            windows[f].brink = std::max(windows[f].brink, part.brink);
            windows[f].reach = std::max(windows[f].reach, part.reach);
        }
    }
    // Starts of each tile and, inside, of each chunk's share; then slots and bins of the tiles.
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

    const LargeBuffer<SeenRay> sorted(sum);
    executor.for_each_chunk(rays.size(), chunk, [&](std::size_t begin, std::size_t end) {
        std::vector<std::uint32_t>& starts = shares[begin / chunk].starts;
        for (std::size_t i = begin; i < end; ++i) {
            if (tile_of[i] == no_tile) continue;
            Placed placed{};
            static_cast<void>(place(pencil, faces, rays[i], placed));
            const Tile& tile = tiles[tile_of[i]];
            const FaceRay& ray = placed.ray;
            // Outward, by more than roundings of the depths and of t come to.
            const auto margin = [&](double end_depth) {
                return 4 * 0x1p-24 * (std::abs(end_depth) + ray.scale);
            };
            sorted[starts[tile_of[i]]++] = {
                static_cast<float>(ray.u - tile.u),
                static_cast<float>(ray.v - tile.v),
                static_cast<float>(ray.near - margin(ray.near)),
                static_cast<float>(ray.far + margin(ray.far)),
                static_cast<float>(ray.scale * (1 + 0x1p-22)),
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
                asked != RaysAsked::all
            );
    });
}

std::size_t RayTiles::most_bytes(std::size_t rays) {
    return rays * (sizeof(std::uint32_t) + sizeof(SeenRay)) +
           most_slots(rays) * (6 + 2) * sizeof(float) +
           most_bin_starts(rays) * sizeof(std::uint32_t) +
           most_tiles(rays) * (sizeof(Tile) + 33 * 4);
}

} // namespace raywise::detail
