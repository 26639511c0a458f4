// The rays of a batch, sorted into the tiles of their pictures and the bins of their tiles.
#pragma once

#include "pencil/inversion/extremes.hpp"
#include "pencil/inversion/face.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/core/large_buffer.hpp>
#include <raywise/geometry/ray.hpp>
#include <raywise/pencil/pencil.hpp>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace raywise::detail {

inline constexpr float unit_roundoff = 0x1p-24F;
inline constexpr float infinity = std::numeric_limits<float>::infinity();

/// Vectors may be read, not written, up to this many slots beyond the rays of a tile.
inline constexpr std::uint32_t tile_alignment = 16;

[[nodiscard]] inline std::uint32_t padded_slots(std::uint32_t count) {
    return (count + 2 * tile_alignment - 2) / tile_alignment * tile_alignment;
}

/// The part of a face that its rays are in, cut into tiles. The outermost tiles reach to infinity.
struct Window {
    double u = 0, v = 0; ///< lower corner
    double per_u = 0, per_v = 0;
    std::uint32_t columns = 1, rows = 1;
    std::uint32_t first_tile = 0;
    double u_lo = std::numeric_limits<double>::infinity(); ///< bounds of the rays
    double u_hi = -std::numeric_limits<double>::infinity();
    double v_lo = std::numeric_limits<double>::infinity();
    double v_hi = -std::numeric_limits<double>::infinity();
    double brink = 0; ///< greatest FaceRay::brink
    double tiny = 0;  ///< greatest FaceRay::scale beside the depth
    double reach = 0; ///< greatest depth at which a ray of a radial pencil starts

    [[nodiscard]] bool is_empty() const { return !(u_lo <= u_hi); }

    [[nodiscard]] static std::uint32_t place(double offset, std::uint32_t count) {
        // Not a number: anywhere.
        if (!(offset > 0)) return 0;
        return offset < count ? static_cast<std::uint32_t>(offset) : count - 1;
    }

    [[nodiscard]] std::uint32_t column(double at) const { return place((at - u) * per_u, columns); }

    [[nodiscard]] std::uint32_t row(double at) const { return place((at - v) * per_v, rows); }

    void include(const Window& part) {
        u_lo = lesser(u_lo, part.u_lo);
        u_hi = greater(u_hi, part.u_hi);
        v_lo = lesser(v_lo, part.v_lo);
        v_hi = greater(v_hi, part.v_hi);
        brink = greater(brink, part.brink);
        tiny = greater(tiny, part.tiny);
        reach = greater(reach, part.reach);
    }

    void include(const FaceRay& ray) {
        u_lo = lesser(u_lo, ray.u);
        u_hi = greater(u_hi, ray.u);
        v_lo = lesser(v_lo, ray.v);
        v_hi = greater(v_hi, ray.v);
        brink = greater(brink, ray.brink);
        tiny = greater(tiny, ray.tiny);
        reach = greater(reach, std::abs(ray.start));
    }
};

/// The rays seen in one rectangle of a window. Its slots are sorted by rows of bins; slots that are
/// decided are dropped now and then.
struct alignas(64) Tile {
    double u = 0, v = 0;     ///< center; coordinates of its rays are relative to it
    std::uint32_t first = 0; ///< slot
    std::uint32_t count = 0;
    std::uint32_t bins = 0; ///< where its bin starts begin: columns * rows + 1 of them
    std::uint32_t columns = 1, rows = 1;
    float u0 = 0, v0 = 0; ///< lower corner of the bins
    float per_u = 0, per_v = 0;
    float half_u = 0, half_v = 0; ///< greatest coordinates by magnitude
    /// Bounds of the intervals of the rays kept.
    std::atomic<float> near{infinity};
    std::atomic<float> far{-infinity};
    float start = 0; ///< greatest depth by magnitude at which a ray starts
    float scale = 0; ///< the same, more by FaceRay::tiny
    std::atomic<std::uint32_t> undecided{0};
    std::atomic<bool> busy{false};

    [[nodiscard]] static std::uint32_t place(float offset, std::uint32_t count) {
        if (!(offset > 0)) return 0;
        return offset < static_cast<float>(count) ? static_cast<std::uint32_t>(offset) : count - 1;
    }

    [[nodiscard]] std::uint32_t column(float at) const { return place((at - u0) * per_u, columns); }

    [[nodiscard]] std::uint32_t row(float at) const { return place((at - v0) * per_v, rows); }
};

enum class Running : std::uint8_t { nowhere, leaving, arriving };

/// Which rays of the batch are asked about.
enum class RaysAsked : std::uint8_t { all, leaving, arriving };

class RayTiles {
public:
    /// Throws Error for a valid ray that the pencil does not hold.
    RayTiles(
        const Pencil& pencil,
        std::span<const Ray> rays,
        RaysAsked asked,
        const Executor& executor
    );

    [[nodiscard]] static std::size_t most_bytes(std::size_t rays);

    std::vector<Face> faces;
    std::vector<Window> windows; ///< one per face
    std::vector<Tile> tiles;
    std::size_t seen = 0;    ///< rays that are valid and asked about
    std::size_t skipped = 0; ///< rays that are valid and not asked about

    // By slot. A slot that is decided has near > far.
    LargeBuffer<float> u, v;
    LargeBuffer<float> near, far; ///< rounded outward
    LargeBuffer<std::uint32_t> excluded;
    LargeBuffer<std::uint32_t> index; ///< of the ray in the batch
    // Closest hits only: the nearest hit so far and a depth that is surely before it.
    LargeBuffer<float> least;
    LargeBuffer<std::uint32_t> best;

    LargeBuffer<std::uint32_t> bin_starts; ///< relative to the first slot of the tile

private:
    /// Where a ray of the batch is seen, while it is sorted.
    struct Placed {
        std::uint32_t tile : 28;
        std::uint32_t face : 3;
        std::uint32_t leaves : 1;
    };

    /// What one part of the batch adds.
    struct Share {
        std::vector<std::uint32_t> starts; ///< by tile: first a count, then a place
        std::vector<Window> windows;
        std::size_t seen = 0;
        std::size_t skipped = 0;
    };

    template <bool is_radial>
    void sort(
        const Pencil& pencil,
        std::span<const Ray> rays,
        RaysAsked asked,
        const Executor& executor
    );

    /// Gives every tile its slots and bins, and every share its place in them. Returns where the
    /// rays of each tile begin when they are sorted by tile.
    std::vector<std::uint32_t> lay_out(std::vector<Share>& shares);
};

} // namespace raywise::detail
