#include "pencil/build_face.hpp"
#include "pencil/cell_builder.hpp"
#include "pencil/edge_lines.hpp"
#include "pencil/face_map.hpp"
#include "pencil/face_pieces.hpp"
#include "pencil/footprint.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/piece.hpp"
#include "pencil/raster.hpp"
#include "pencil/records.hpp"

#include <raywise/core/executor.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil_grid_params.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace raywise::pencil_detail {

namespace {

constexpr std::size_t chunk = 1 << 13;
constexpr double side_units = 1 << top_shift;

struct Range {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();

    void add(double value) {
        least = std::min(least, value);
        greatest = std::max(greatest, value);
    }

    void add(const Range& other) {
        least = std::min(least, other.least);
        greatest = std::max(greatest, other.greatest);
    }

    [[nodiscard]] double size() const { return greatest - least; }
};

struct Ranges {
    Range u, v, key;
};

Ranges measure(const std::vector<RawPiece>& pieces, const Executor& executor) {
    std::vector<Ranges> parts((pieces.size() + chunk - 1) / chunk);
    executor.for_each_chunk(pieces.size(), chunk, [&](std::size_t begin, std::size_t end) {
        Ranges ranges;
        for (std::size_t i = begin; i < end; ++i)
            for (std::size_t k = 0; k < 3; ++k) {
                ranges.u.add(pieces[i].u[k]);
                ranges.v.add(pieces[i].v[k]);
                ranges.key.add(static_cast<double>(pieces[i].key[k]));
            }
        parts[begin / chunk] = ranges;
    });
    Ranges all;
    for (const Ranges& part : parts) {
        all.u.add(part.u);
        all.v.add(part.v);
        all.key.add(part.key);
    }
    return all;
}

/// Chooses the cells and completes the map. Returns how far, in units, a place may be off by the
/// roundings of the map.
double scale(
    Face& face,
    const Ranges& ranges,
    std::size_t pieces,
    bool is_radial,
    double greatest_coordinate,
    double cell_size
) {
    FaceMap& map = face.map;
    // Never thinner than what rounding leaves of the coordinates.
    const double magnitude = is_radial ? 1 : greatest_coordinate;
    const double thinnest = std::max(magnitude * 0x1p-24, 0x1p-140);
    const double wide = std::max(ranges.u.size(), thinnest);
    const double high = std::max(ranges.v.size(), thinnest);
    const double cells = std::max(1.0, static_cast<double>(pieces) / cell_size);
    const double side = std::sqrt(wide / cells * high);
    const auto cells_along = [&](double extent) {
        return static_cast<std::int32_t>(
            std::clamp(std::ceil(extent / side), 1.0, double{most_cells_a_side})
        );
    };
    face.width = cells_along(wide);
    face.height = cells_along(high);
    map.size_u = face.width * side_units;
    map.size_v = face.height * side_units;
    // Some units are left free around the geometry.
    constexpr double border = 64;
    map.scale_u = (map.size_u - 2 * border) / wide;
    map.scale_v = (map.size_v - 2 * border) / high;
    map.offset_u = ranges.u.least * map.scale_u - border;
    map.offset_v = ranges.v.least * map.scale_v - border;
    map.slope_u *= map.scale_u;
    map.slope_v *= map.scale_v;
    // Keys may be off. Never so thin that double arithmetic with them, or with a parallel reach of
    // 2^8 times as much, would be off by a unit.
    const double largest = std::max(std::abs(ranges.key.least), std::abs(ranges.key.greatest));
    const double least_key = ranges.key.least - largest * key_rounding;
    const double greatest_key = ranges.key.greatest + largest * key_rounding;
    const double deep = std::max({greatest_key - least_key, largest * 0x1p-14, 0x1p-90});
    map.depth_scale = (deepest - shallowest - 8) / deep;
    map.depth_offset = shallowest - least_key * map.depth_scale;
    map.depth_slack = 4 + 0x1p-148 * static_cast<double>(map.speed) * map.depth_scale;
    map.front = is_radial ? -1 / least_key : least_key;
    // t / (1 - t) for the share t of a ray.
    const double strays = stray_share * std::max(map.scale_u, map.scale_v);
    map.most_t = is_radial ? 0.25 / (strays + 0.25) : std::numeric_limits<double>::infinity();
    set_lanes(map, is_radial);
    const double greatest = is_radial ? 2 : 4 * map.reach;
    return 0x1p-49 * greatest * std::max(map.scale_u, map.scale_v);
}

std::vector<Piece> snap(
    const std::vector<RawPiece>& raw,
    const Face& face,
    double rounding,
    const Executor& executor
) {
    const FaceMap& map = face.map;
    std::vector<Piece> pieces(raw.size());
    // What is farther outside is cut off by radial faces.
    const auto units = [](double x) {
        return static_cast<std::int32_t>(nearest(std::clamp(x, -0x1p28, 0x1p29)));
    };
    executor.for_each_chunk(raw.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            const RawPiece& from = raw[i];
            Piece& piece = pieces[i];
            for (std::size_t k = 0; k < 3; ++k) {
                piece.u[k] = units(from.u[k] * map.scale_u - map.offset_u);
                piece.v[k] = units(from.v[k] * map.scale_v - map.offset_v);
            }
            piece.key = from.key;
            const double strays =
                static_cast<double>(from.margin) * std::max(map.scale_u, map.scale_v);
            piece.margin =
                4 + static_cast<std::int32_t>(std::min(std::ceil(rounding + strays), 0x1p27));
            piece.prim = from.prim;
            piece.is_part = from.is_part;
            piece.is_near = from.is_near;
        }
    });
    return pieces;
}

/// The pieces of every cell: those of cell i are pieces[starts[i]] to pieces[starts[i + 1]].
struct Contents {
    std::vector<std::size_t> starts;
    std::vector<std::uint32_t> pieces;
};

bool fill(
    Contents& contents,
    const BuiltFace& built,
    std::size_t most_references,
    const Executor& executor
) {
    const Face& face = built.face;
    const auto cells = static_cast<std::size_t>(face.width) * static_cast<std::size_t>(face.height);
    std::vector<std::uint32_t> counts(cells);
    const auto for_each_reference = [&](auto&& visit) {
        const std::vector<Piece>& pieces = built.pieces;
        executor.for_each_chunk(pieces.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i)
                for_each_cell(pieces[i], face.width, face.height, [&](std::size_t cell) {
                    visit(cell, static_cast<std::uint32_t>(i));
                });
        });
    };
    for_each_reference([&](std::size_t cell, std::uint32_t) {
        std::atomic_ref(counts[cell]).fetch_add(1, std::memory_order_relaxed);
    });
    contents.starts.resize(cells + 1);
    std::size_t total = 0;
    for (std::size_t i = 0; i < cells; ++i) {
        contents.starts[i] = total;
        total += counts[i];
    }
    contents.starts[cells] = total;
    if (total > most_references) return false;
    contents.pieces.resize(total);
    // Any order within a cell: lists are sorted later.
    for_each_reference([&](std::size_t cell, std::uint32_t piece) {
        const std::uint32_t left =
            std::atomic_ref(counts[cell]).fetch_sub(1, std::memory_order_relaxed);
        contents.pieces[contents.starts[cell] + left - 1] = piece;
    });
    return true;
}

void add(PencilGridStatistics& to, const PencilGridStatistics& from) {
    to.leaves += from.leaves;
    to.empty += from.empty;
    to.splits += from.splits;
    to.references += from.references;
    to.culled += from.culled;
}

void build_cells(
    BuiltFace& built,
    const Contents& contents,
    const EdgeLines& edges,
    bool is_radial,
    const PencilGridParams& params,
    const Executor& executor
) {
    const Face& face = built.face;
    const std::size_t cells = contents.starts.size() - 1;
    built.cells.resize(cells);
    built.part_cells = std::max<std::size_t>(16, cells / 256);
    built.parts.resize((cells + built.part_cells - 1) / built.part_cells);
    executor.for_each_chunk(cells, built.part_cells, [&](std::size_t begin, std::size_t end) {
        auto builder =
            std::make_unique<CellBuilder>(face.map, is_radial, built.pieces, edges, params);
        const auto width = static_cast<std::size_t>(face.width);
        for (std::size_t i = begin; i < end; ++i) {
            const Window window{
                static_cast<std::int32_t>(i % width) << top_shift,
                static_cast<std::int32_t>(i / width) << top_shift,
                1 << top_shift
            };
            built.cells[i] = builder->build(
                std::span(contents.pieces)
                    .subspan(contents.starts[i], contents.starts[i + 1] - contents.starts[i]),
                window
            );
        }
        built.parts[begin / built.part_cells] = std::move(builder);
    });
    for (const auto& part : built.parts) {
        built.list_bytes += part->lists().size();
        add(built.statistics, part->statistics());
    }
    built.statistics.faces = 1;
    built.statistics.top_cells = cells;
}

} // namespace

std::unique_ptr<BuiltFace> build_face(
    const std::vector<RawPiece>& pieces,
    const FaceMap& unscaled,
    const Records& records,
    bool is_radial,
    Vec3d apex,
    const PencilGridParams& params,
    double coarsening,
    std::size_t most_references,
    const Executor& executor
) {
    auto built = std::make_unique<BuiltFace>();
    built->face.map = unscaled;
    const double rounding = scale(
        built->face,
        measure(pieces, executor),
        pieces.size(),
        is_radial,
        records.greatest(),
        params.cell_size * coarsening
    );
    built->pieces = snap(pieces, built->face, rounding, executor);
    Contents contents;
    if (!fill(contents, *built, most_references, executor)) return nullptr;
    const EdgeLines edges(built->face.map, is_radial, records, apex, rounding);
    build_cells(*built, contents, edges, is_radial, params, executor);
    return built;
}

} // namespace raywise::pencil_detail
