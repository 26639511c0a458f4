#include "pencil/build_face.hpp"
#include "pencil/face_map.hpp"
#include "pencil/face_pieces.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/kernels.hpp"
#include "pencil/records.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/executor.hpp>
#include <raywise/geometry/triangle_view.hpp>
#include <raywise/geometry/vec.hpp>
#include <raywise/pencil/pencil_grid.hpp>
#include <raywise/pencil/pencil_grid_params.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

namespace raywise {

namespace {

using namespace pencil_detail;

/// The free part of the cap on a grid's bytes.
constexpr std::size_t least_bytes = 1 << 16;

/// Larger coordinates are left to exact arithmetic. Differences to points within reach are below
/// 2^10 of them, and products of three are the largest numbers.
constexpr double tame = 0x1p50;

using Faces = std::array<std::unique_ptr<BuiltFace>, 6>;

/// The faces of a pencil before their cells are chosen.
struct RawFaces {
    std::array<std::vector<RawPiece>, 6> pieces;
    std::array<FaceMap, 6> maps{};
};

RawFaces raw_faces(PencilGrid::Data& data, const Records& records, const Executor& executor) {
    RawFaces faces;
    if (data.pencil.kind() == Pencil::Kind::parallel) {
        const Vec3 direction = data.pencil.direction();
        const int axis = dominant_axis(direction);
        FaceMap& map = faces.maps[0];
        map.axis = axis;
        map.axis_u = (axis + 1) % 3;
        map.axis_v = (axis + 2) % 3;
        const Vec3d d = to_double(direction);
        map.sign = d[axis] > 0 ? 1 : -1;
        map.slope_u = d[map.axis_u] / d[axis];
        map.slope_v = d[map.axis_v] / d[axis];
        map.reach = 256 * records.greatest();
        map.shear_u = direction[map.axis_u] / direction[axis];
        map.shear_v = direction[map.axis_v] / direction[axis];
        map.speed = std::abs(direction[axis]);
        // NaN: no t does, as an infinite one would be no hit.
        const float whole = 1.01F * static_cast<float>(2 * map.reach) / map.speed;
        map.whole_t = std::isfinite(whole) ? whole : std::numeric_limits<float>::quiet_NaN();
        // Without triangles nothing is too far away.
        if (records.ids().empty()) map.reach = std::numeric_limits<double>::infinity();
        data.is_tame = records.greatest() < tame;
        set_lanes(map, false);
        faces.pieces[0] = parallel_pieces(records, direction, executor);
        return faces;
    }
    const Vec3d apex = data.apex;
    Surroundings around = look_around(records, apex, executor);
    const double farthest = records.farthest_from(apex);
    data.is_tame =
        std::max(
            {records.greatest(), farthest, std::abs(apex.x), std::abs(apex.y), std::abs(apex.z)}
        ) < tame;
    for (std::size_t face = 0; face < 6; ++face) {
        FaceMap& map = faces.maps[face];
        map.axis = static_cast<int>(face / 2);
        map.axis_u = (map.axis + 1) % 3;
        map.axis_v = (map.axis + 2) % 3;
        map.sign = face % 2 == 0 ? 1 : -1;
        map.reach = around.reach;
        set_lanes(map, true);
        faces.pieces[face] = radial_pieces(records, around, face, executor);
    }
    data.near = std::move(around.near);
    data.has_near = !data.near.empty();
    return faces;
}

std::size_t bytes(const Faces& faces) {
    std::size_t total = 0;
    for (const auto& face : faces)
        if (face) total += face->cells.size() * sizeof(Cell) + face->list_bytes + 16;
    return total;
}

/// Puts all faces' cells, then all lists into one piece of memory.
void assemble(
    PencilGrid::Data& data,
    const Faces& faces,
    const RawFaces& raw,
    const Executor& executor
) {
    std::size_t cell_bytes = 0;
    for (const auto& face : faces)
        if (face) cell_bytes += (face->cells.size() * sizeof(Cell) + 15) / 16 * 16;
    std::size_t total = cell_bytes;
    for (const auto& face : faces)
        if (face) total += face->list_bytes;
    data.memory.emplace(total + slack_bytes);
    data.memory_bytes = total;
    std::byte* memory = data.memory->get();
    std::memset(memory + total, 0, slack_bytes);
    data.lists = memory + cell_bytes;

    std::size_t cells_at = 0;
    std::size_t lists_at = 0;
    for (std::size_t f = 0; f < faces.size(); ++f) {
        data.faces[f].map = raw.maps[f];
        if (!faces[f]) continue;
        BuiltFace& built = *faces[f];
        Face& face = data.faces[f];
        face = built.face;
        std::vector<std::size_t> starts;
        for (const auto& part : built.parts) {
            starts.push_back(lists_at);
            lists_at += part->lists().size();
        }
        auto* cells = reinterpret_cast<Cell*>(memory + cells_at);
        face.cells = cells;
        executor.for_each_chunk(built.parts.size(), 1, [&](std::size_t i, std::size_t) {
            const auto words = static_cast<std::uint32_t>(starts[i] / 16);
            built.parts[i]->write(memory + cell_bytes + starts[i], words);
            const std::size_t end = std::min(built.cells.size(), (i + 1) * built.part_cells);
            for (std::size_t k = i * built.part_cells; k < end; ++k) {
                Cell cell = built.cells[k];
                if (!cell.is_empty()) cell.link += words;
                std::memcpy(&cells[k], &cell, sizeof cell);
            }
        });
        const std::size_t size = built.cells.size() * sizeof(Cell);
        const std::size_t whole = (size + 15) / 16 * 16;
        std::memset(memory + cells_at + size, 0, whole - size);
        cells_at += whole;
    }
}

void add(PencilGridStatistics& to, const PencilGridStatistics& from) {
    to.faces += from.faces;
    to.top_cells += from.top_cells;
    to.leaves += from.leaves;
    to.empty += from.empty;
    to.splits += from.splits;
    to.references += from.references;
    to.culled += from.culled;
}

} // namespace

void check(const PencilGridParams& params) {
    if (!(params.cell_size >= 1 && params.cell_size <= 256))
        throw Error("cell_size must be in [1, 256]");
    if (params.leaf_size < 4 || params.leaf_size > 4096)
        throw Error("leaf_size must be in [4, 4096]");
    if (!(params.bytes_per_triangle >= 64)) throw Error("bytes_per_triangle must be at least 64");
}

PencilGrid build_pencil_grid(
    const TriangleView& triangles,
    const Pencil& pencil,
    const PencilGridParams& params,
    const Executor& executor
) {
    check(params);
    const std::size_t count = triangles.size();
    if (count > 0x7FFFFFFF) throw Error("pencil grid: more than 2^31 triangles");
    auto data = std::make_unique<PencilGrid::Data>(pencil);
    data->kernels = &best_kernels();
    if (pencil.kind() == Pencil::Kind::radial) data->apex = to_double(pencil.apex());
    data->triangles = triangles;
    const Records records(triangles, executor);

    const RawFaces raw = raw_faces(*data, records, executor);
    const double cap = params.bytes_per_triangle * static_cast<double>(count) + least_bytes;
    // References may be dropped later, and others be made by splits.
    const auto most_references = static_cast<std::size_t>(cap / 4);
    PencilGridParams coarser = params;
    double coarsening = 1;
    Faces faces;
    for (;;) {
        // One cell a face: there is nothing coarser.
        const bool is_last = coarsening > 0x1p32;
        bool fits = true;
        for (std::size_t f = 0; f < faces.size() && fits; ++f) {
            faces[f].reset();
            if (raw.pieces[f].empty()) continue;
            faces[f] = build_face(
                raw.pieces[f],
                raw.maps[f],
                records,
                pencil.kind() == Pencil::Kind::radial,
                data->apex,
                coarser,
                coarsening,
                is_last ? std::numeric_limits<std::size_t>::max() : most_references,
                executor
            );
            fits = faces[f] != nullptr;
        }
        if (is_last || (fits && static_cast<double>(bytes(faces)) <= cap)) break;
        ++data->statistics.coarsened;
        coarsening *= 2;
        coarser.leaf_size = std::min(2 * coarser.leaf_size, 1U << 24U);
    }
    assemble(*data, faces, raw, executor);
    for (const auto& face : faces)
        if (face) add(data->statistics, face->statistics);
    data->statistics.near = data->near.size();
    return PencilGrid(std::move(data));
}

} // namespace raywise
