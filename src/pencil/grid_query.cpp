// Queries of a pencil grid. One file, because it is compiled once for each instruction set.
#include "pencil/face_map.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/kernels.hpp"
#include "pencil/sharp_filter.hpp"

#include <raywise/geometry/ray_triangle.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <vector>

#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pencil/grid_query.cpp"
// The order matters: foreach_target.h includes this file anew for every target.
// clang-format off
#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include "pencil/line_filter.hpp"
// clang-format on

HWY_BEFORE_NAMESPACE();

namespace raywise::pencil_detail::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

/// Counts nothing, costs nothing.
struct NoCounts {
    static void query() {}
    static void cell() {}
    static void list(std::size_t) {}
    static void prim() {}
    static void decided() {}
};

struct Counts {
    PencilGridCounts* counts;

    void query() const { ++counts->queries; }
    void cell() const { ++counts->cells; }
    void list(std::size_t references) const {
        ++counts->lists;
        counts->references += references;
    }
    void prim() const { ++counts->prims; }
    void decided() const { ++counts->decided; }
};

/// Which way a ray of the pencil runs.
enum class Heading : std::uint8_t { to_emitter, from_emitter };

/// The place of a ray in a face.
struct Spot {
    const Face* face;
    std::int32_t u, v;    ///< units
    std::int32_t deepest; ///< no hit is deeper, in units
    std::int32_t sure;    ///< what is not deeper is on the near side of the ray's far end
    bool is_whole;        ///< whether the ray reaches the emitter's side of all geometry
    double origin_z;      ///< depth of the origin
};

enum class Where : std::uint8_t {
    inside,
    outside, ///< where nothing is
    unknown, ///< too far away to say
};

HWY_INLINE float component(const Vec3& v, int axis) {
    float x = 0;
    std::memcpy(
        &x,
        reinterpret_cast<const std::byte*>(&v) + static_cast<std::size_t>(axis) * sizeof x,
        sizeof x
    );
    return x;
}

/// The face of a direction from the apex, without branches: lamps look everywhere.
HWY_INLINE std::size_t face_of(const std::array<double, 3>& seen) {
    const double x = std::abs(seen[0]);
    const double y = std::abs(seen[1]);
    const double z = std::abs(seen[2]);
    const auto is_x = static_cast<std::size_t>(x >= y) & static_cast<std::size_t>(x >= z);
    const std::size_t axis = (1 - is_x) * (2 - static_cast<std::size_t>(y >= z));
    return 2 * axis + static_cast<std::size_t>(seen[axis] < 0);
}

/// limited_depth without branches.
HWY_INLINE std::int32_t limited(double units) {
    const hn::CappedTag<double, 1> d;
    return static_cast<std::int32_t>(hn::GetLane(
        hn::Max(hn::Min(hn::Set(d, units), hn::Set(d, static_cast<double>(deepest))), hn::Zero(d))
    ));
}

template <Heading heading>
HWY_INLINE Where locate(const Grid& grid, const Ray& ray, Spot& spot) {
    Place place;
    double speed = 0;
    bool is_known = false;
    if (grid.pencil.kind() == Pencil::Kind::parallel) {
        spot.face = grid.faces.data();
        const FaceMap& map = spot.face->map;
        place = parallel_place(
            map,
            static_cast<double>(component(ray.origin, map.axis_u)),
            static_cast<double>(component(ray.origin, map.axis_v)),
            static_cast<double>(component(ray.origin, map.axis))
        );
        speed = static_cast<double>(map.speed);
        is_known = std::abs(place.z) <= map.reach;
    } else {
        const Vec3d rays = heading == Heading::to_emitter ? to_double(ray.origin) - grid.apex
                                                          : to_double(ray.direction);
        const std::array<double, 3> seen{rays.x, rays.y, rays.z};
        spot.face = &grid.faces[face_of(seen)];
        const FaceMap& map = spot.face->map;
        const auto seen_along = [&](int axis) { return seen[static_cast<std::size_t>(axis)]; };
        place =
            radial_place(map, seen_along(map.axis_u), seen_along(map.axis_v), seen_along(map.axis));
        // The rounded direction of a shadow ray is as long up to 2^-23.
        speed = place.z;
        if constexpr (heading == Heading::from_emitter) place.z = 0;
        is_known = place.z <= map.reach;
    }
    const FaceMap& map = spot.face->map;
    if (!is_known) [[unlikely]]
        return Where::unknown;
    if (!(place.u >= 0 && place.v >= 0 && place.u < map.size_u && place.v < map.size_v))
        return Where::outside;
    spot.u = static_cast<std::int32_t>(place.u);
    spot.v = static_cast<std::int32_t>(place.v);
    spot.origin_z = place.z;

    constexpr double under = 1 - 0x1p-21;
    constexpr double over = 1 + 0x1p-21;
    constexpr std::int32_t rounding = 4;
    const double units = depth_units_of(map, place.z);
    const double scale = speed * map.depth_scale;
    const double start = static_cast<double>(ray.t_min) * scale;
    if constexpr (heading == Heading::to_emitter) {
        spot.deepest = limited(units - start * under + map.depth_slack);
        spot.sure = limited(units - start * over - map.depth_slack) - rounding;
        spot.is_whole = ray.t_max >= map.whole_t;
    } else {
        // Hits at an infinite t do not count.
        const float t_max = std::min(ray.t_max, std::numeric_limits<float>::max());
        const double end = static_cast<double>(t_max) * scale;
        spot.deepest = limited(units + end * over + map.depth_slack);
        spot.sure = limited(units + end * under - map.depth_slack) - rounding;
        spot.is_whole = units + start * over + map.depth_slack < shallowest - rounding;
    }
    return Where::inside;
}

/// The ray as a filter of triangles wants it.
template <Heading heading>
HWY_INLINE Line line_of(const Grid& grid, const Ray& ray, const Face& face) {
    const FaceMap& map = face.map;
    const float direction_z = component(ray.direction, map.axis);
    const float speed = std::abs(direction_z);
    Line line;
    line.origin_u = component(ray.origin, map.axis_u);
    line.origin_v = component(ray.origin, map.axis_v);
    line.origin_z = component(ray.origin, map.axis);
    if (grid.pencil.kind() == Pencil::Kind::parallel) {
        line.shear_u = map.shear_u;
        line.shear_v = map.shear_v;
    } else {
        line.shear_u = component(ray.direction, map.axis_u) / direction_z;
        line.shear_v = component(ray.direction, map.axis_v) / direction_z;
    }
    line.least = ray.t_min * speed;
    // Hits at an infinite t do not count.
    line.greatest = std::min(ray.t_max, std::numeric_limits<float>::max()) * speed;
    // t is rounded to a multiple of 2^-149; but a denormal factor would cost a hundred cycles.
    line.slack = 0x1p-120F + speed * 0x1p-100F;
    line.sign = static_cast<float>(heading == Heading::to_emitter ? -map.sign : map.sign);
    line.doubt = grid.doubt;
    line.at_u = static_cast<std::size_t>(3 * map.axis_u);
    line.at_v = static_cast<std::size_t>(3 * map.axis_v);
    line.at_z = static_cast<std::size_t>(3 * map.axis);
    return line;
}

/// The list that a ray must look through, or a verdict without one.
struct Leaf {
    Cell cell;
    int shift; ///< its side is 2^shift units
    bool has_verdict;
    Verdict verdict;
};

/// Where in its cell of side 2^shift a place is, in 2^-15.
HWY_INLINE std::int16_t fine_place(std::int32_t units, int shift) {
    return static_cast<std::int16_t>(
        ((static_cast<std::uint32_t>(units) << (top_shift - shift)) & 0xFFFFU) >> 1U
    );
}

HWY_INLINE const Cell* top_cell(const Spot& spot) {
    const Face& face = *spot.face;
    return face.cells + static_cast<std::ptrdiff_t>(spot.v >> top_shift) * face.width +
           (spot.u >> top_shift);
}

/// `decides_hits`: whether a ray that passes two triangles may be answered "hit" at once.
template <class Count>
HWY_INLINE Leaf find_leaf(const Grid& grid, const Spot& spot, bool decides_hits, Count count) {
    const Cell* cell = top_cell(spot);
    const std::int32_t sure_256 = decides_hits ? spot.sure >> 8 : -1;
    int shift = top_shift;
    for (;;) {
        count.cell();
        const Cell here = *cell;
        const std::int32_t plane =
            here.slope_u * fine_place(spot.u, shift) + here.slope_v * fine_place(spot.v, shift);
        const bool is_miss = spot.deepest < here.base + (plane >> 15) * (1 << here.shift);
        const bool is_hit = sure_256 > here.cover;
        if (is_miss | is_hit) return {here, shift, true, is_miss ? Verdict::miss : Verdict::hit};
        if ((here.link & Cell::split_mark) == 0) return {here, shift, false, Verdict::miss};
        shift -= split_bits;
        const auto child =
            static_cast<std::size_t>(((spot.v >> shift) & 3) * 4 + ((spot.u >> shift) & 3));
        cell = reinterpret_cast<const Cell*>(
                   grid.lists + std::size_t{here.link & ~Cell::split_mark} * 16
               ) +
               child;
    }
}

HWY_INLINE void prefetch(const void* address) {
#if HWY_COMPILER_GCC || HWY_COMPILER_CLANG
    __builtin_prefetch(address);
#else
    (void)address;
#endif
}

/// A query's place in a cell and its depth, as the list has them.
struct Probe {
    std::int8_t u, v;            ///< in 1/256, less 128
    std::int16_t u_fine, v_fine; ///< in 2^-15
    std::int16_t depth;
};

#if HWY_TARGET == HWY_SCALAR

/// Bit i is set when reference i of the chunk may be met.
inline std::uint32_t touched(const std::byte* chunk, std::size_t size, const Probe& probe) {
    const auto* at = reinterpret_cast<const std::int8_t*>(chunk);
    const std::size_t stride = padded(size);
    std::uint32_t bits = 0;
    for (std::size_t i = 0; i < size; ++i) {
        const auto number = [&](std::size_t row) {
            std::int16_t x = 0;
            std::memcpy(&x, chunk + row * stride + 2 * i, sizeof x);
            return int{x};
        };
        const auto product = [](int slope, int place) { return (slope * place + 0x4000) >> 15; };
        const int here =
            number(8) + product(number(4), probe.u_fine) + product(number(6), probe.v_fine);
        if (at[i] <= probe.u && at[stride + i] >= probe.u && at[2 * stride + i] <= probe.v &&
            at[3 * stride + i] >= probe.v && static_cast<std::int16_t>(here) <= probe.depth)
            bits |= 1U << i;
    }
    return bits;
}

#else

using Bytes = hn::CappedTag<std::int8_t, chunk_size>;
using Words = hn::CappedTag<std::int16_t, chunk_size>;

/// Bit i is set when reference i of the chunk may be met.
HWY_INLINE std::uint32_t touched(const std::byte* chunk, std::size_t size, const Probe& probe) {
    const std::size_t stride = padded(size);
    const auto* const at = reinterpret_cast<const std::int8_t*>(chunk);
    std::uint8_t bytes[8];
    const auto add = [&](std::uint32_t& bits, std::size_t lanes, std::size_t first) HWY_ATTR {
        std::uint32_t part = 0;
        std::memcpy(&part, bytes, lanes / 8);
        bits |= part << first;
    };
    std::uint32_t outside = 0;

    const Bytes d;
    const auto u = hn::Set(d, probe.u);
    const auto v = hn::Set(d, probe.v);
    for (std::size_t i = 0; i < chunk_size; i += hn::Lanes(d)) {
        const auto row = [&](std::size_t k) HWY_ATTR { return hn::LoadU(d, at + k * stride + i); };
        const auto is_outside = hn::Or(
            hn::Or(hn::Gt(row(0), u), hn::Lt(row(1), u)),
            hn::Or(hn::Gt(row(2), v), hn::Lt(row(3), v))
        );
        hn::StoreMaskBits(d, is_outside, bytes);
        add(outside, hn::Lanes(d), i);
    }
    const Words w;
    const auto u_fine = hn::Set(w, probe.u_fine);
    const auto v_fine = hn::Set(w, probe.v_fine);
    const auto depth = hn::Set(w, probe.depth);
    for (std::size_t i = 0; i < chunk_size; i += hn::Lanes(w)) {
        const auto row = [&](std::size_t k) HWY_ATTR {
            return hn::LoadU(w, reinterpret_cast<const std::int16_t*>(at + k * stride + 2 * i));
        };
        const auto here = hn::Add(
            row(8),
            hn::Add(hn::MulFixedPoint15(row(4), u_fine), hn::MulFixedPoint15(row(6), v_fine))
        );
        hn::StoreMaskBits(w, hn::Gt(here, depth), bytes);
        add(outside, hn::Lanes(w), i);
    }
    return ~outside & (0xFFFFFFFFU >> (chunk_size - size));
}

#endif

/// Asks for the start of a leaf's list ahead of its use.
HWY_INLINE void prefetch_list(const Grid& grid, const Leaf& leaf) {
    const std::byte* at = grid.lists + std::size_t{leaf.cell.link} * 16;
    for (std::size_t line = 0; line < 4; ++line)
        prefetch(at + 64 * line);
}

/// A query's way through a list.
struct Walk {
    const std::byte* at; ///< the chunk
    std::size_t left;    ///< references from there on
    std::int32_t base;
    int shift;
    Probe probe;

    /// Sets how deep hits may be; whether a reference is as near.
    [[nodiscard]] HWY_INLINE bool aim(std::int32_t deepest_hit) {
        if (deepest_hit < base) return false;
        probe.depth = static_cast<std::int16_t>(std::min((deepest_hit - base) >> shift, 32767));
        return true;
    }

    [[nodiscard]] HWY_INLINE std::size_t size() const { return std::min(left, chunk_size); }

    [[nodiscard]] HWY_INLINE const std::byte* ids() const { return at + 10 * padded(size()); }

    [[nodiscard]] HWY_INLINE std::uint32_t candidates() const { return touched(at, size(), probe); }

    /// Goes to the next chunk, if one may matter.
    [[nodiscard]] HWY_INLINE bool advance() {
        if (left <= chunk_size) return false;
        left -= chunk_size;
        at += chunk_bytes(chunk_size);
        std::int16_t least = 0;
        std::memcpy(&least, at, sizeof least);
        at += chunk_head_bytes;
        return least <= probe.depth;
    }
};

HWY_INLINE Walk walk(const Grid& grid, const Leaf& leaf, const Spot& spot) {
    const std::byte* const at = grid.lists + std::size_t{leaf.cell.link} * 16;
    ListHead head;
    std::memcpy(&head, at, sizeof head);
    Probe probe{0, 0, fine_place(spot.u, leaf.shift), fine_place(spot.v, leaf.shift), 0};
    probe.u = static_cast<std::int8_t>((probe.u_fine >> 7) - 128);
    probe.v = static_cast<std::int8_t>((probe.v_fine >> 7) - 128);
    return {at + sizeof head, head.count(), head.base, head.shift(), probe};
}

HWY_INLINE const float* record(const Grid& grid, PrimId id) {
    return grid.records + to_index(id) * record_floats;
}

/// The id of the first bit, which is taken away.
HWY_INLINE PrimId pop(const std::byte* ids, std::uint32_t& bits) {
    PrimId id;
    std::memcpy(&id, ids + sizeof id * static_cast<std::size_t>(std::countr_zero(bits)), sizeof id);
    bits &= bits - 1;
    return id;
}

/// When the first filter left a doubt.
template <class Count>
HWY_NOINLINE bool
is_hit_after_all(const Grid& grid, const Ray& ray, const Line& line, PrimId id, Count count) {
    if (line.doubt < 1)
        if (const auto hit = sharp_hit(ray, record(grid, id), line.at_z / 3)) return *hit;
    count.decided();
    return decide(grid, ray, id, ray.t_max).has_value();
}

template <class Count>
HWY_INLINE bool is_hit(const Grid& grid, const Ray& ray, const Line& line, PrimId id, Count count) {
    if (id == ray.excluded) return false;
    count.prim();
    const Finding finding = quick_cross(line, record(grid, id));
    if (finding == Finding::doubt) return is_hit_after_all(grid, ray, line, id, count);
    return finding == Finding::hit;
}

/// Whether the leaf's list has all triangles that the ray may meet.
HWY_INLINE bool is_complete(const Spot& spot, const Leaf& leaf) {
    return (spot.deepest >> 8) <= leaf.cell.cover;
}

/// Radial: triangles at the apex.
template <class Count>
HWY_NOINLINE bool is_near_hit(const Grid& grid, const Ray& ray, const Line& line, Count count) {
    for (const PrimId id : grid.near)
        if (is_hit(grid, ray, line, id, count)) return true;
    return false;
}

/// any_hit in a leaf's list.
template <Heading heading, class Count>
HWY_INLINE Verdict
look_through(const Grid& grid, const Ray& ray, const Spot& spot, const Leaf& leaf, Count count) {
    Walk way = walk(grid, leaf, spot);
    count.list(way.left);
    if (!way.aim(spot.deepest)) return Verdict::miss;
    do {
        std::uint32_t bits = way.candidates();
        if (bits == 0) continue;
        const Line line = line_of<heading>(grid, ray, *spot.face);
        const std::byte* const ids = way.ids();
        do {
            if (is_hit(grid, ray, line, pop(ids, bits), count)) return Verdict::hit;
        } while (bits != 0);
    } while (way.advance());
    return is_complete(spot, leaf) ? Verdict::miss : Verdict::unknown;
}

template <Heading heading, class Count>
HWY_INLINE Verdict any_hit_along(const Grid& grid, const Ray& ray, Count count) {
    count.query();
    Spot spot{};
    const Where where = locate<heading>(grid, ray, spot);
    if (where == Where::unknown) [[unlikely]]
        return is_valid(ray) ? Verdict::unknown : Verdict::miss;
    if (!grid.near.empty()) [[unlikely]] {
        if (is_near_hit(grid, ray, line_of<heading>(grid, ray, *spot.face), count))
            return Verdict::hit;
    }
    if (where == Where::outside) return Verdict::miss;
    const Leaf leaf = find_leaf(grid, spot, spot.is_whole, count);
    if (leaf.has_verdict) return leaf.verdict;
    prefetch_list(grid, leaf);
    return look_through<heading>(grid, ray, spot, leaf, count);
}

/// The closest hit so far, decided or not yet.
template <class Count>
class Closest {
public:
    Closest(const Grid& grid, const Ray& ray, const Line& line, Count count)
        : grid_(grid), ray_(ray), line_(line), count_(count) {
        best_.t = ray.t_max;
    }

    /// Whether `reach` became shorter.
    HWY_INLINE bool add(PrimId id) {
        if (id == ray_.excluded || id == pending_ || id == best_.prim) return false;
        count_.prim();
        const Crossing crossing = cross(line_, record(grid_, id));
        if (crossing.finding == Finding::miss) return false;
        const float before = reach_;
        if (crossing.finding == Finding::doubt) {
            decide_now(id);
            return reach_ < before;
        }
        if (crossing.depth - crossing.error > reach_) return false;
        if (pending_ != no_prim &&
            crossing.depth + crossing.error >= pending_depth_.depth - pending_depth_.error) {
            decide_now(pending_);
            pending_ = no_prim;
            decide_now(id);
            return reach_ < before;
        }
        pending_ = id;
        pending_depth_ = crossing;
        reach_ = std::min(reach_, crossing.depth + crossing.error);
        return reach_ < before;
    }

    /// No closer hit is farther along the ray.
    [[nodiscard]] float reach() const { return reach_; }

    [[nodiscard]] HWY_INLINE bool finish(Hit& hit) {
        if (pending_ != no_prim) decide_now(pending_);
        pending_ = no_prim;
        if (best_.prim != no_prim) hit = best_;
        return best_.prim != no_prim;
    }

private:
    void decide_now(PrimId id) {
        count_.decided();
        const auto hit = decide(grid_, ray_, id, best_.t);
        if (!hit || !(best_.prim == no_prim || is_closer(*hit, best_))) return;
        best_ = *hit;
        // A rounded t and the product's rounding.
        reach_ = std::min(reach_, hit->t * std::abs(speed()) * (1 + 0x1p-20F) + line_.slack);
    }

    [[nodiscard]] float speed() const { return ray_.direction[static_cast<int>(line_.at_z / 3)]; }

    const Grid& grid_;
    const Ray& ray_;
    const Line& line_;
    Count count_;
    Hit best_{};
    PrimId pending_ = no_prim;
    Crossing pending_depth_{};
    float reach_ = std::numeric_limits<float>::infinity();
};

template <Heading heading, class Count>
HWY_INLINE Verdict closest_hit_along(const Grid& grid, const Ray& ray, Hit& hit, Count count) {
    count.query();
    Spot spot{};
    const Where where = locate<heading>(grid, ray, spot);
    if (where == Where::unknown) [[unlikely]]
        return is_valid(ray) ? Verdict::unknown : Verdict::miss;
    const Line line = line_of<heading>(grid, ray, *spot.face);
    Closest closest(grid, ray, line, count);
    for (const PrimId id : grid.near)
        closest.add(id);
    if (where == Where::inside) {
        const auto limit = [&]() HWY_ATTR {
            if constexpr (heading == Heading::from_emitter) {
                const double reach =
                    spot.origin_z + static_cast<double>(closest.reach()) * (1 + 0x1p-40);
                spot.deepest =
                    std::min(spot.deepest, limited(depth_units_of(spot.face->map, reach)) + 4);
            }
        };
        limit();
        const Leaf leaf = find_leaf(grid, spot, false, count);
        if (!leaf.has_verdict) {
            prefetch_list(grid, leaf);
            Walk way = walk(grid, leaf, spot);
            count.list(way.left);
            bool is_open = way.aim(spot.deepest);
            while (is_open) {
                std::uint32_t bits = way.candidates();
                const std::byte* const ids = way.ids();
                while (bits != 0 && is_open) {
                    if (!closest.add(pop(ids, bits))) continue;
                    limit();
                    is_open = way.aim(spot.deepest);
                    if (bits != 0) bits &= way.candidates();
                }
                is_open = is_open && way.advance();
            }
            if (!is_complete(spot, leaf)) return Verdict::unknown;
        }
    }
    return closest.finish(hit) ? Verdict::hit : Verdict::miss;
}

template <Heading heading>
Verdict all_hits_along(const Grid& grid, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    Spot spot{};
    const Where where = locate<heading>(grid, ray, spot);
    if (where == Where::unknown) return is_valid(ray) ? Verdict::unknown : Verdict::miss;
    const Line line = line_of<heading>(grid, ray, *spot.face);
    bool found = false;
    const auto add = [&](PrimId id) HWY_ATTR {
        if (id == ray.excluded) return;
        if (cross(line, record(grid, id)).finding == Finding::miss) return;
        if (const auto hit = decide(grid, ray, id, ray.t_max)) {
            found = true;
            visit(*hit);
        }
    };
    for (const PrimId id : grid.near)
        add(id);
    if (where == Where::inside) {
        const Leaf leaf = find_leaf(grid, spot, false, NoCounts{});
        if (!leaf.has_verdict) {
            Walk way = walk(grid, leaf, spot);
            bool is_open = way.aim(spot.deepest);
            while (is_open) {
                std::uint32_t bits = way.candidates();
                const std::byte* const ids = way.ids();
                while (bits != 0) {
                    const PrimId id = pop(ids, bits);
                    if (std::find(grid.near.begin(), grid.near.end(), id) == grid.near.end())
                        add(id);
                }
                is_open = way.advance();
            }
            if (!is_complete(spot, leaf)) return Verdict::unknown;
        }
    }
    return found ? Verdict::hit : Verdict::miss;
}

Heading heading_of(const Grid& grid, const Ray& ray) {
    const bool is_away = grid.pencil.kind() == Pencil::Kind::parallel
                             ? ray.direction == grid.pencil.direction()
                             : ray.origin == grid.pencil.apex();
    return is_away ? Heading::from_emitter : Heading::to_emitter;
}

Verdict Occluded(const Grid& grid, Vec3 point, float t_min, PrimId excluded) {
    const Ray ray = grid.pencil.shadow_ray(point, t_min, excluded);
    return any_hit_along<Heading::to_emitter>(grid, ray, NoCounts{});
}

template <class Count>
HWY_INLINE Verdict any_hit_of(const Grid& grid, const Ray& ray, Count count) {
    return heading_of(grid, ray) == Heading::to_emitter
               ? any_hit_along<Heading::to_emitter>(grid, ray, count)
               : any_hit_along<Heading::from_emitter>(grid, ray, count);
}

Verdict AnyHit(const Grid& grid, const Ray& ray) {
    return any_hit_of(grid, ray, NoCounts{});
}

Verdict AnyHitCounted(const Grid& grid, const Ray& ray, PencilGridCounts& counts) {
    return any_hit_of(grid, ray, Counts{&counts});
}

template <class Count>
HWY_INLINE Verdict closest_hit_of(const Grid& grid, const Ray& ray, Hit& hit, Count count) {
    return heading_of(grid, ray) == Heading::to_emitter
               ? closest_hit_along<Heading::to_emitter>(grid, ray, hit, count)
               : closest_hit_along<Heading::from_emitter>(grid, ray, hit, count);
}

Verdict ClosestHit(const Grid& grid, const Ray& ray, Hit& hit) {
    return closest_hit_of(grid, ray, hit, NoCounts{});
}

Verdict ClosestHitCounted(const Grid& grid, const Ray& ray, Hit& hit, PencilGridCounts& counts) {
    return closest_hit_of(grid, ray, hit, Counts{&counts});
}

Verdict AllHits(const Grid& grid, const Ray& ray, FunctionRef<void(const Hit&)> visit) {
    return heading_of(grid, ray) == Heading::to_emitter
               ? all_hits_along<Heading::to_emitter>(grid, ray, visit)
               : all_hits_along<Heading::from_emitter>(grid, ray, visit);
}

/// Rays of a batch that are answered together: while one waits for memory, the others go on.
constexpr std::size_t together = 16;

/// any_hit for a few rays toward the emitter: `ray_at(i)`, i < count <= together.
template <class RayAt>
HWY_INLINE void
any_hit_together(const Grid& grid, std::size_t count, const RayAt& ray_at, Verdict* verdicts) {
    std::array<Spot, together> spots;
    std::array<Leaf, together> leaves;
    std::array<std::uint8_t, together> open{};
    constexpr auto heading = Heading::to_emitter;

    std::size_t left = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const Ray ray = ray_at(i);
        const Where where = locate<heading>(grid, ray, spots[i]);
        verdicts[i] = Verdict::miss;
        if (where == Where::unknown && is_valid(ray)) verdicts[i] = Verdict::unknown;
        if (where != Where::inside) continue;
        open[left++] = static_cast<std::uint8_t>(i);
        prefetch(top_cell(spots[i]));
    }
    std::size_t kept = 0;
    for (std::size_t k = 0; k < left; ++k) {
        const std::size_t i = open[k];
        leaves[i] = find_leaf(grid, spots[i], spots[i].is_whole, NoCounts{});
        verdicts[i] = leaves[i].verdict;
        prefetch_list(grid, leaves[i]);
        open[kept] = static_cast<std::uint8_t>(i);
        kept += static_cast<std::size_t>(!leaves[i].has_verdict);
    }
    left = kept;
    kept = 0;
    for (std::size_t k = 0; k < left; ++k) {
        const std::size_t i = open[k];
        Walk way = walk(grid, leaves[i], spots[i]);
        std::uint32_t bits = way.aim(spots[i].deepest) ? way.candidates() : 0;
        if (bits != 0) {
            const float* const first = record(grid, pop(way.ids(), bits));
            prefetch(first);
            prefetch(first + record_floats - 1);
        } else if (way.left <= chunk_size && is_complete(spots[i], leaves[i])) {
            continue;
        }
        open[kept++] = static_cast<std::uint8_t>(i);
    }
    for (std::size_t k = 0; k < kept; ++k) {
        const std::size_t i = open[k];
        verdicts[i] = look_through<heading>(grid, ray_at(i), spots[i], leaves[i], NoCounts{});
    }
}

void OccludedBatch(const Grid& grid, const PointBatch& batch, Verdict* verdicts) {
    const auto ray_at = [&](std::size_t i) {
        return grid.pencil.shadow_ray(
            batch.points[i], batch.t_min, batch.excluded == nullptr ? no_prim : batch.excluded[i]
        );
    };
    for (std::size_t first = 0; first < batch.count; first += together) {
        const std::size_t count = std::min(together, batch.count - first);
        if (grid.near.empty()) {
            any_hit_together(
                grid,
                count,
                [&](std::size_t i) HWY_ATTR { return ray_at(first + i); },
                verdicts + first
            );
            continue;
        }
        for (std::size_t i = first; i < first + count; ++i)
            verdicts[i] = any_hit_along<Heading::to_emitter>(grid, ray_at(i), NoCounts{});
    }
}

void AnyHitBatch(const Grid& grid, const Ray* rays, std::size_t batch_size, Verdict* verdicts) {
    for (std::size_t first = 0; first < batch_size; first += together) {
        const std::size_t count = std::min(together, batch_size - first);
        bool are_shadows = grid.near.empty();
        for (std::size_t i = first; i < first + count; ++i)
            are_shadows = are_shadows && heading_of(grid, rays[i]) == Heading::to_emitter;
        if (are_shadows) {
            any_hit_together(
                grid,
                count,
                [&](std::size_t i) HWY_ATTR { return rays[first + i]; },
                verdicts + first
            );
            continue;
        }
        for (std::size_t i = first; i < first + count; ++i)
            verdicts[i] = any_hit_of(grid, rays[i], NoCounts{});
    }
}

const Kernels kernels{
    hwy::TargetName(HWY_TARGET),
    Occluded,
    AnyHit,
    AnyHitCounted,
    ClosestHit,
    ClosestHitCounted,
    AllHits,
    OccludedBatch,
    AnyHitBatch
};

const Kernels* GetKernels() {
    return &kernels;
}

} // namespace raywise::pencil_detail::HWY_NAMESPACE

HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace raywise::pencil_detail {

HWY_EXPORT(GetKernels);

namespace {

std::vector<const Kernels*> collect_kernels() {
    std::vector<const Kernels*> all;
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
        hwy::SetSupportedTargetsForTest(target);
        hwy::GetChosenTarget().Update(hwy::SupportedTargets());
        all.push_back(HWY_DYNAMIC_DISPATCH(GetKernels)());
    }
    hwy::SetSupportedTargetsForTest(0);
    hwy::GetChosenTarget().Update(hwy::SupportedTargets());
    return all;
}

} // namespace

std::span<const Kernels* const> all_kernels() {
    static const std::vector<const Kernels*> all = collect_kernels();
    return all;
}

const Kernels& best_kernels() {
    return *all_kernels().front();
}

std::optional<Hit> decide(const Grid& grid, const Ray& ray, PrimId id, float t_max) {
    const float* r = grid.records + to_index(id) * record_floats;
    const Triangle triangle{{r[0], r[3], r[6]}, {r[1], r[4], r[7]}, {r[2], r[5], r[8]}};
    return ExactKernel::decide(ray, triangle, id, t_max);
}

} // namespace raywise::pencil_detail

#endif
