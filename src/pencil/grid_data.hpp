// The layout of a pencil grid: what queries read.
#pragma once

#include <raywise/core/large_buffer.hpp>
#include <raywise/pencil/pencil_grid.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <vector>

namespace raywise::pencil_detail {

/// A cell's side is 2^16 units at the top and a quarter of its parent's below. Eight more bits tell
/// where in a leaf something is, so four levels of splits are the most.
inline constexpr int top_shift = 16;
inline constexpr int place_bits = 8;
inline constexpr int split_bits = 2;
inline constexpr std::size_t children = 16;
inline constexpr std::int32_t most_cells_a_side = 4096;

/// Depths, in units: [0, deepest]. Geometry has [shallowest, deepest], so that what lies before it
/// is below, and a `cover` of 24 bits can say "never".
inline constexpr std::int32_t shallowest = 256;
inline constexpr std::int32_t deepest = (1 << 30) - 257;
inline constexpr int cover_shift = 6;

/// A cell of the top grid, or one of 16 siblings. All it holds lies at or behind a plane: at the
/// place (u, v), in 2^-15 of the cell, base + ((slope_u * u + slope_v * v) >> 15) * 2^shift, in
/// units. A query that ends before meets nothing. One that comes from the emitter and ends beyond
/// `cover`, in 2^cover_shift units, meets at least two triangles. The lists are complete up to
/// `cover`, itself included.
struct Cell {
    std::uint32_t link = 0; ///< where its list or children are, in 16 bytes; with `split_mark`
    std::int32_t base = nothing;
    std::int16_t slope_u = 0; ///< at most 2^14 in magnitude
    std::int16_t slope_v = 0;
    std::uint32_t cover : 24 = never;
    std::uint32_t shift : 8 = 0;

    static constexpr std::int32_t nothing = 0x7FFFFFFF; ///< base of a cell without triangles
    static constexpr std::uint32_t never = 0xFFFFFF;
    static constexpr std::uint32_t split_mark = 0x80000000U;

    [[nodiscard]] bool is_empty() const { return base == nothing; }
};
static_assert(sizeof(Cell) == 16);

/// The head of a list; chunks of 32 references follow, the last one shorter, a multiple of 4.
/// Before every chunk but the first stands its least depth, 32 bits. A chunk of n references is
/// `edge_rows` and two rows of n 16-bit numbers, see `Row`, then n bases, n ids and n shifts.
/// References ascend by least depth.
struct ListHead {
    std::uint32_t count; ///< references

    static constexpr std::size_t most_references = (1U << 26U) - 1;
};
static_assert(sizeof(ListHead) == 4);

/// The rows of a chunk. A place (u, v) counts half cells from the middle of its cell, in 2^-15.
/// Products with a place are times 2^-15, rounded; sums of edges saturate.
///
/// Edge i of a reference's triangle has at the place the value e_i = edge_at[i] + edge_u[i] * u +
/// edge_v[i] * v. A ray of the cell that meets the triangle has every e_i > -edge_doubt; one with
/// every e_i >= edge_doubt passes through its inside. A ray that meets it does so, in units, within
/// depth_doubt * 2^shift of the depth base + (depth_u * u + depth_v * v) * 2^shift; where no ray
/// meets it, this may be too large for 32 bits. The products added up fit 16 bits, and so does the
/// difference of a depth and the base 32.
enum Row : std::size_t {
    edge_u = 0,  ///< and 3, 6
    edge_v = 1,  ///< and 4, 7
    edge_at = 2, ///< and 5, 8
    edge_rows = 9,
    depth_u = 9,
    depth_v = 10,
    depth_base = 11, ///< of 32 bits
    prim_row = 13,   ///< of 32 bits
    depth_shift = 15 ///< of 8 bits
};

inline constexpr int edge_doubt = 8;
inline constexpr int depth_doubt = 3;
inline constexpr unsigned least_shift = 4; ///< of depths: finer ones would tell nothing

inline constexpr std::size_t chunk_size = 32;

[[nodiscard]] constexpr std::size_t padded(std::size_t count) {
    return (count + 3) / 4 * 4;
}

/// Bytes from one chunk of `count` references to the next.
[[nodiscard]] constexpr std::size_t chunk_bytes(std::size_t count) {
    return (2 * depth_shift + 1) * padded(count);
}

/// Bytes before every chunk but the first.
inline constexpr std::size_t chunk_head_bytes = 4;

/// Bytes of a list, a multiple of 16.
[[nodiscard]] constexpr std::size_t list_bytes(std::size_t count) {
    const std::size_t whole = (count - 1) / chunk_size;
    const std::size_t bytes = sizeof(ListHead) +
                              whole * (chunk_bytes(chunk_size) + chunk_head_bytes) +
                              chunk_bytes(count - whole * chunk_size);
    return (bytes + 15) / 16 * 16;
}

/// From the world to units. Parallel: u = x * scale - z * slope - offset for the coordinate x along
/// the u axis and z along the depth axis; radial: u = x / z * scale - offset for coordinates from
/// the apex, z > 0. Depth: key * depth_scale + depth_offset, where the key is z, radial -1 / z: so
/// depths of a plane are linear in u and v.
struct FaceMap {
    double scale_u = 0, slope_u = 0, offset_u = 0;
    double scale_v = 0, slope_v = 0, offset_v = 0;
    double depth_scale = 0, depth_offset = 0;
    double size_u = 0, size_v = 0; ///< units; what is outside meets nothing
    double sign = 1;               ///< z is the coordinate along the axis times this
    double reach = 0;              ///< greatest |z| that a query may begin or end at
    double front = 0;              ///< no geometry has a smaller z
    int axis = 0, axis_u = 1, axis_v = 2;
    float shear_u = 0, shear_v = 0; ///< parallel: direction u / z and v / z
    float speed = 0;                ///< parallel: |direction z|
    double most_t = 0; ///< rays toward an apex that begin later may stray from their place by more
                       ///< than a quarter unit before they begin
    float whole_t = 1; ///< a ray toward the emitter with such a t_max passes all geometry
    double depth_slack = 4; ///< units that a rounded t may be off, beside a share of it

    // The same map for queries, four numbers at a time: u, v, and units of depth twice, more and
    // less than what they are off. Parallel: the sum of the columns for x, y, z and 1, each times
    // its coordinate, to which a length of ray times `toward`, or `away` from the emitter, is
    // added. Radial: the columns of x, y and z, each times its coordinate, and `dividend` are
    // divided by z: for depths by that of the ray's end, for which such a length is added to z.
    using Lanes = std::array<double, 4>;
    alignas(32) std::array<Lanes, 4> columns{};
    Lanes dividend{};
    Lanes toward{}, away{};
    Lanes least{}, limit{}; ///< before a length is added; others are outside or too far away
};

struct Face {
    FaceMap map;
    const Cell* cells = nullptr; ///< row by row, u first
    std::int32_t width = 0;      ///< cells along u
    std::int32_t height = 0;
};

struct Kernels;

/// Bytes that may be read beyond the last list.
inline constexpr std::size_t slack_bytes = 128;

} // namespace raywise::pencil_detail

namespace raywise {

struct PencilGrid::Data {
    explicit Data(const Pencil& p) : pencil(p) {}

    Pencil pencil;
    const pencil_detail::Kernels* kernels = nullptr;
    std::array<pencil_detail::Face, 6> faces{}; ///< 2 * axis + (1 when negative); parallel: 0
    const std::byte* lists = nullptr;           ///< lists and split cells
    TriangleView triangles;
    std::vector<PrimId> near; ///< radial: triangles at the apex
    bool has_near = false;    ///< whether there are such
    Vec3d apex{};
    bool is_tame = false; ///< whether coordinates are small enough for `sharp_hit`

    std::optional<LargeBuffer<std::byte>> memory; ///< top cells of all faces, then lists
    std::size_t memory_bytes = 0;
    PencilGridStatistics statistics{};
};

} // namespace raywise
