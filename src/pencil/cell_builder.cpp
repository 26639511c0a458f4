#include "pencil/cell_builder.hpp"
#include "pencil/face_map.hpp"

#include <raywise/core/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <tuple>

namespace raywise::pencil_detail {

namespace {

constexpr std::int32_t never = std::numeric_limits<std::int32_t>::max();

/// Splitting pays when the children together have less than so many times the references: longer
/// triangles would be listed again and again.
constexpr double worthwhile_growth = 2.5;

/// Depths of a list are within this, and what planes add to it.
constexpr std::int32_t greatest_depth = 24000;

std::size_t level_of(int shift) {
    return static_cast<std::size_t>((top_shift - shift) / split_bits);
}

} // namespace

Cell CellBuilder::build(std::span<const std::uint32_t> pieces, const Window& window, int shift) {
    std::vector<Reference>& references = references_[level_of(shift)];
    references.clear();
    for (const std::uint32_t index : pieces) {
        const Piece& piece = pieces_[index];
        const Footprint place = footprint(piece, window);
        if (place.least_u > place.greatest_u) continue;
        const EdgeRows edges = edges_.rows(piece, place, window);
        if (edges.is_missed) continue;
        double least = place.least_key;
        double greatest = place.greatest_key;
        if (is_radial_) {
            // The keys were rounded to float.
            least = -1 / least * (1 - 0x1p-20);
            greatest = -1 / greatest * (1 + 0x1p-20);
        }
        references.push_back(
            {place,
             plane_of(piece, place, window),
             std::max(depth_units(map_, least) - 1, 0),
             depth_units(map_, greatest) + 1,
             edges,
             index,
             piece.prim,
             false}
        );
    }
    Cell cell;
    if (references.empty()) {
        ++statistics_.empty;
        return cell;
    }
    const std::int32_t cover = cull(references);
    if (cover != never) cell.cover = static_cast<std::uint16_t>(cover);
    set_near(cell, references, window);
    if (references.size() > params_.leaf_size && shift > place_bits &&
        split(references, window, shift, cell))
        return cell;
    add_list(references, window, cell);
    return cell;
}

/// Drops what two triangles that fill the window hide; returns their depth in 256 units, or never.
std::int32_t CellBuilder::cull(std::vector<Reference>& references) {
    // One of the two may be the triangle that a ray starts on and does not hit.
    std::int32_t first = never;
    std::int32_t second = never;
    PrimId first_prim = no_prim;
    for (const Reference& reference : references) {
        if (!reference.place.fills) continue;
        if (reference.prim == first_prim) {
            first = std::min(first, reference.greatest);
        } else if (reference.greatest < first) {
            second = first;
            first = reference.greatest;
            first_prim = reference.prim;
        } else {
            second = std::min(second, reference.greatest);
        }
    }
    if (second == never) return never;
    const std::int32_t cover = second >> 8;
    const auto is_hidden = [&](const Reference& reference) {
        return (reference.least >> 8) > cover;
    };
    const auto kept = std::remove_if(references.begin(), references.end(), is_hidden);
    statistics_.culled += static_cast<std::size_t>(references.end() - kept);
    references.erase(kept, references.end());
    return cover;
}

bool CellBuilder::split(
    const std::vector<Reference>& references,
    const Window& window,
    int shift,
    Cell& cell
) {
    const int child_shift = shift - split_bits;
    auto& lists = child_pieces_[level_of(shift)];
    for (auto& list : lists)
        list.clear();
    std::size_t total = 0;
    for (const Reference& reference : references) {
        const Footprint& place = reference.place;
        const std::int32_t last_row = (place.greatest_v - window.first_v) >> child_shift;
        const std::int32_t last_column = (place.greatest_u - window.first_u) >> child_shift;
        for (auto row = (place.least_v - window.first_v) >> child_shift; row <= last_row; ++row)
            for (auto column = (place.least_u - window.first_u) >> child_shift;
                 column <= last_column;
                 ++column) {
                lists[static_cast<std::size_t>(row * 4 + column)].push_back(reference.piece);
                ++total;
            }
    }
    const auto most = worthwhile_growth * static_cast<double>(references.size());
    if (static_cast<double>(total) > most) return false;

    ++statistics_.splits;
    const std::size_t at = grow(children * sizeof(Cell));
    splits_.push_back(at);
    cell.link = Cell::split_mark | static_cast<std::uint32_t>(at / 16);
    for (std::size_t i = 0; i < children; ++i) {
        const auto row = static_cast<std::int32_t>(i / 4);
        const auto column = static_cast<std::int32_t>(i % 4);
        const Window part{
            window.first_u + (column << child_shift),
            window.first_v + (row << child_shift),
            std::int32_t{1} << child_shift
        };
        const Cell child = build(lists[i], part, child_shift);
        std::memcpy(lists_.data() + at + i * sizeof(Cell), &child, sizeof child);
    }
    return true;
}

/// One reference for each triangle.
void CellBuilder::merge_parts(std::vector<Reference>& references) const {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < references.size(); ++i) {
        const Reference& reference = references[i];
        const auto end = references.begin() + static_cast<std::ptrdiff_t>(kept);
        const auto other = pieces_[reference.piece].is_part
                               ? std::find_if(
                                     references.begin(),
                                     end,
                                     [&](const Reference& r) { return r.prim == reference.prim; }
                                 )
                               : end;
        if (other == end) {
            references[kept++] = reference;
            continue;
        }
        Footprint& place = other->place;
        place.least_u = std::min(place.least_u, reference.place.least_u);
        place.greatest_u = std::max(place.greatest_u, reference.place.greatest_u);
        place.least_v = std::min(place.least_v, reference.place.least_v);
        place.greatest_v = std::max(place.greatest_v, reference.place.greatest_v);
        other->least = std::min(other->least, reference.least);
        other->greatest = std::max(other->greatest, reference.greatest);
        if (pieces_[other->piece].margin < pieces_[reference.piece].margin) {
            other->edges = reference.edges;
            other->piece = reference.piece;
        }
        other->is_merged = true;
    }
    references.resize(kept);
}

void CellBuilder::add_list(std::vector<Reference>& references, const Window& window, Cell& cell) {
    if (is_radial_) merge_parts(references);
    const std::size_t count = references.size();
    if (count > ListHead::most_references) throw Error("pencil grid: too many triangles in a cell");
    std::sort(references.begin(), references.end(), [](const Reference& a, const Reference& b) {
        return std::tie(a.least, a.prim) < std::tie(b.least, b.prim);
    });
    const std::int32_t first_depth = references.front().least;
    int depth_shift = 0;
    while (((references.back().least - first_depth) >> depth_shift) > 2 * greatest_depth)
        ++depth_shift;
    const std::int32_t base = first_depth + (greatest_depth << depth_shift);

    ++statistics_.leaves;
    statistics_.references += count;
    const std::size_t at = grow(list_bytes(count));
    cell.link = static_cast<std::uint32_t>(at / 16);
    const ListHead head{
        base,
        static_cast<std::uint32_t>(count) | static_cast<std::uint32_t>(depth_shift) << 26U |
            (cell.cover != Cell::never ? 1U << 31U : 0U)
    };
    std::byte* to = lists_.data() + at;
    std::memcpy(to, &head, sizeof head);
    to += sizeof head;
    for (std::size_t first = 0; first < count; first += chunk_size) {
        if (first > 0) {
            const auto least =
                static_cast<std::int16_t>((references[first].least - base) >> depth_shift);
            std::memcpy(to, &least, sizeof least);
            to += chunk_head_bytes;
        }
        const std::size_t size = std::min(chunk_size, count - first);
        const std::size_t stride = padded(size);
        for (std::size_t i = 0; i < size; ++i) {
            const Reference& reference = references[first + i];
            const DepthRows depths = depth_rows(reference, window, base, depth_shift);
            const auto put = [&](std::size_t row, std::int16_t value) {
                std::memcpy(to + 2 * (row * stride + i), &value, sizeof value);
            };
            for (std::size_t row = 0; row < 9; ++row)
                put(row, reference.edges.values[row]);
            for (std::size_t row = 0; row < 4; ++row)
                put(depth_u + row, depths[row]);
            std::memcpy(
                to + 2 * list_rows * stride + sizeof(PrimId) * i, &reference.prim, sizeof(PrimId)
            );
        }
        to += chunk_bytes(size);
    }
}

/// How far, in units, the depth -1 / key rises above its tangent in the middle of the bounds, whose
/// slopes are `scale` times those of the key. It is convex, so at a corner.
double CellBuilder::bulge(
    const KeyPlane& plane,
    const Footprint& bounds,
    std::int32_t margin,
    double scale
) const {
    const double half_u = 0.5 * (bounds.greatest_u + 1 - bounds.least_u) + margin + 3;
    const double half_v = 0.5 * (bounds.greatest_v + 1 - bounds.least_v) + margin + 3;
    const double middle = plane.at(
        0.5 * (bounds.least_u + bounds.greatest_u + 1),
        0.5 * (bounds.least_v + bounds.greatest_v + 1)
    );
    double most = 0;
    for (const double to_u : {-half_u, half_u})
        for (const double to_v : {-half_v, half_v}) {
            const double rise = plane.slope_u * to_u + plane.slope_v * to_v;
            const double key = middle + rise;
            if (!(key < 0.25 * middle)) return std::numeric_limits<double>::infinity();
            const double z = -1 / key;
            const double depth = (z + 1 / middle) * map_.depth_scale;
            most = std::max(most, depth - rise * scale + 0x1p-18 * z * map_.depth_scale);
        }
    return most;
}

/// The plane of a parallel piece; of a radial one, whose depth -1 / key is a convex function of the
/// place, the tangent in the middle of its bounds, which is nowhere beyond.
CellBuilder::Plane
CellBuilder::plane_of(const Piece& piece, const Footprint& bounds, const Window& window) const {
    const auto plane = key_plane(piece);
    if (!plane) return {};
    const double middle_u = 0.5 * (bounds.least_u + bounds.greatest_u + 1);
    const double middle_v = 0.5 * (bounds.least_v + bounds.greatest_v + 1);
    double middle = plane->at(middle_u, middle_v);
    double scale = map_.depth_scale;
    double error = 2;
    if (is_radial_) {
        if (!(middle < 0)) return {};
        const double z = -1 / middle;
        error += z * 0x1p-19 * scale;
        scale *= z * z;
        middle = z;
    }
    const double side = window.side;
    Plane tangent{
        depth_units_of(map_, middle) - error,
        plane->slope_u * scale * side,
        plane->slope_v * scale * side,
        0,
        true
    };
    const double rounding = (std::abs(tangent.slope_u) + std::abs(tangent.slope_v)) * 0x1p-20;
    tangent.middle -= rounding;
    tangent.above = 2 * (error + rounding);
    if (is_radial_) tangent.above += bulge(*plane, bounds, piece.margin, scale);
    tangent.is_known = std::abs(tangent.middle) < 0x1p29;
    return tangent;
}

namespace {

/// Where queries may be that meet a reference, in shares of the cell. A query's place is rounded
/// down to 2^-15 and to units, and off by the margin and by what the piece was snapped.
struct Span {
    double at_u, at_v;
    double half_u, half_v;
    double off;

    Span(const Footprint& bounds, const Window& window, std::int32_t margin)
        : at_u((0.5 * (bounds.least_u + bounds.greatest_u + 1) - window.first_u) / window.side)
        , at_v((0.5 * (bounds.least_v + bounds.greatest_v + 1) - window.first_v) / window.side)
        , half_u(0.5 * (bounds.greatest_u + 1 - bounds.least_u) / window.side)
        , half_v(0.5 * (bounds.greatest_v + 1 - bounds.least_v) / window.side)
        , off(0x1p-15 + (margin + 3.0) / window.side) {
        half_u += off;
        half_v += off;
    }
};

} // namespace

/// The plane that all references are behind: with the slopes of the one that takes most of the
/// cell, or level, whichever is farther in the middle.
void CellBuilder::set_near(
    Cell& cell,
    const std::vector<Reference>& references,
    const Window& window
) const {
    const Reference* widest = nullptr;
    double widest_area = 0;
    cell.base = never;
    for (const Reference& reference : references) {
        cell.base = std::min(cell.base, reference.least);
        const Footprint& place = reference.place;
        const double area = static_cast<double>(place.greatest_u + 1 - place.least_u) *
                            static_cast<double>(place.greatest_v + 1 - place.least_v);
        if (reference.plane.is_known && area > widest_area) {
            widest = &reference;
            widest_area = area;
        }
    }
    if (widest == nullptr) return;
    const double steepest =
        std::max(std::abs(widest->plane.slope_u), std::abs(widest->plane.slope_v));
    int shift = 0;
    while (std::ldexp(16000.0, shift) < steepest)
        if (++shift > 12) return;
    const double unit = std::ldexp(1.0, shift);
    const double whole_u = nearest(widest->plane.slope_u / unit);
    const double whole_v = nearest(widest->plane.slope_v / unit);
    const double slope_u = whole_u * unit;
    const double slope_v = whole_v * unit;
    double base = std::numeric_limits<double>::infinity();
    for (const Reference& reference : references) {
        const Span span(reference.place, window, pieces_[reference.piece].margin);
        const double start = slope_u * span.at_u + slope_v * span.at_v;
        const double level = reference.least - start - std::abs(slope_u) * span.half_u -
                             std::abs(slope_v) * span.half_v;
        double lowest = level;
        if (const Plane& plane = reference.plane; plane.is_known)
            lowest = std::max(
                lowest,
                plane.middle - start - std::abs(plane.slope_u - slope_u) * span.half_u -
                    std::abs(plane.slope_v - slope_v) * span.half_v
            );
        base = std::min(base, lowest - (std::abs(slope_u) + std::abs(slope_v)) * span.off);
    }
    base = std::floor(base) - 2;
    if (!(base + 0.5 * (slope_u + slope_v) > cell.base) || !(std::abs(base) < 0x1p29)) return;
    cell.base = static_cast<std::int32_t>(base);
    cell.slope_u = static_cast<std::int16_t>(whole_u);
    cell.slope_v = static_cast<std::int16_t>(whole_v);
    cell.shift = static_cast<std::uint16_t>(shift);
}

CellBuilder::DepthRows CellBuilder::depth_rows(
    const Reference& reference,
    const Window& window,
    std::int32_t base,
    int depth_shift
) const {
    const auto unit = static_cast<double>(std::int64_t{1} << depth_shift);
    const double flat = (reference.least - base) >> depth_shift;
    const double greatest = std::ceil((reference.greatest - base) / unit) + 1;
    const bool is_endless = pieces_[reference.piece].reaches_apex;
    const auto rows = [&](double slope_u, double slope_v, double start, double thick) {
        return DepthRows{
            static_cast<std::int16_t>(slope_u),
            static_cast<std::int16_t>(slope_v),
            // Modulo 2^16: right again where the triangle is.
            static_cast<std::int16_t>(static_cast<std::int32_t>(start)),
            is_endless ? endless : static_cast<std::int16_t>(std::min(thick, double{endless}))
        };
    };
    const DepthRows constant = rows(0, 0, flat, greatest - flat);
    // The plane of one snapped part says nothing sure of the others.
    if (!reference.plane.is_known || reference.is_merged) return constant;
    // Over half a cell, as places count.
    const double slope_u = reference.plane.slope_u / (2 * unit);
    const double slope_v = reference.plane.slope_v / (2 * unit);
    const double whole_u = nearest(slope_u);
    const double whole_v = nearest(slope_v);
    if (!(std::abs(whole_u) < 32000 && std::abs(whole_v) < 32000)) return constant;
    const Span span(reference.place, window, pieces_[reference.piece].margin);
    // Two products are rounded, to half a depth each.
    constexpr double rounding = 1;
    const double slack = 2 * ((std::abs(whole_u) + std::abs(whole_v)) * span.off +
                              std::abs(slope_u - whole_u) * span.half_u +
                              std::abs(slope_v - whole_v) * span.half_v) +
                         rounding;
    const double at_middle = (reference.plane.middle - base) / unit - slack;
    // A plane that leaves the numbers, or says less than the least depth, is of no use.
    if (!(at_middle > flat)) return constant;
    const double change =
        2 * (std::abs(whole_u) * span.half_u + std::abs(whole_v) * span.half_v) + rounding;
    const double lowest = at_middle - change;
    if (!(lowest > -32000 && at_middle + change < 32000)) return constant;
    const double start =
        std::floor(at_middle - whole_u * (2 * span.at_u - 1) - whole_v * (2 * span.at_v - 1));
    const double behind = std::ceil(reference.plane.above / unit + 2 * slack + rounding) + 1;
    return rows(whole_u, whole_v, start, std::min(behind, greatest - std::floor(lowest)));
}

std::size_t CellBuilder::grow(std::size_t bytes) {
    const std::size_t at = lists_.size();
    if (at + bytes > std::size_t{Cell::split_mark} * 16) throw Error("pencil grid: too large");
    lists_.resize(at + bytes);
    return at;
}

void CellBuilder::write(std::byte* to, std::uint32_t words) const {
    if (lists_.empty()) return;
    std::memcpy(to, lists_.data(), lists_.size());
    for (const std::size_t at : splits_)
        for (std::size_t i = 0; i < children; ++i) {
            Cell child;
            std::byte* place = to + at + i * sizeof(Cell);
            std::memcpy(&child, place, sizeof child);
            if (!child.is_empty()) child.link += words;
            std::memcpy(place, &child, sizeof child);
        }
}

} // namespace raywise::pencil_detail
