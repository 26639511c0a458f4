#include "pencil/cell_builder.hpp"
#include "pencil/edge_lines.hpp"
#include "pencil/face_map.hpp"
#include "pencil/footprint.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/piece.hpp"

#include <raywise/core/error.hpp>
#include <raywise/core/ids.hpp>

#include <hwy/cache_control.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <vector>

namespace raywise::pencil_detail {

namespace {

constexpr std::int32_t never = std::numeric_limits<std::int32_t>::max();

/// Splitting pays when the children together have less than so many times the references: longer
/// triangles would be listed again and again.
constexpr double worthwhile_growth = 2.5;

/// Pieces of a cell lie anywhere in memory, and so do their triangles: so many are on their way.
constexpr std::size_t ahead = 8;

/// The least shift >= 0, or one more, with which limit * 2^shift >= number: greater than any that
/// is used for what is too large or no number.
unsigned shift_to(double limit, double number) {
    constexpr unsigned exponent_of_1 = 1023;
    const auto bits = std::bit_cast<std::uint64_t>(std::max(number / limit, 0x1p-1));
    return static_cast<unsigned>(bits >> 52U & 0x7FFU) - (exponent_of_1 - 1);
}

double power_of_2(unsigned exponent) {
    return static_cast<double>(std::uint64_t{1} << exponent);
}

std::size_t level_of(int shift) {
    return static_cast<std::size_t>((top_shift - shift) / split_bits);
}

} // namespace

Cell CellBuilder::build(std::span<const std::uint32_t> pieces, const Window& window, int shift) {
    const std::int32_t cover = cover_of(pieces, window);
    std::vector<Reference>& references = references_[level_of(shift)];
    references.clear();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i + ahead < pieces.size()) edges_.prefetch(pieces_[pieces[i + ahead]]);
        add_reference(references, pieces[i], window, cover);
    }
    Cell cell;
    if (references.empty()) {
        ++statistics_.empty;
        return cell;
    }
    if (cover != never) cell.cover = static_cast<std::uint32_t>(cover) & Cell::never;
    set_near(cell, references, window);
    if (references.size() > params_.leaf_size && shift > place_bits &&
        split(references, window, shift, cell))
        return cell;
    add_list(references, cell);
    return cell;
}

std::int32_t CellBuilder::least_depth(double key) const {
    // Radial ones are below zero.
    return std::max(depth_units(map_, is_radial_ ? key * (1 + key_rounding) : key) - 1, 0);
}

std::int32_t CellBuilder::greatest_depth(double key) const {
    return depth_units(map_, is_radial_ ? key * (1 - key_rounding) : key) + 1;
}

/// The depth, as a cell's cover, behind which two triangles that fill the window hide everything;
/// or never.
std::int32_t
CellBuilder::cover_of(std::span<const std::uint32_t> pieces, const Window& window) const {
    // One of the two may be the triangle that a ray starts on and does not hit.
    std::int32_t first = never;
    std::int32_t second = never;
    PrimId first_prim = no_prim;
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        if (i + ahead < pieces.size()) hwy::Prefetch(&pieces_[pieces[i + ahead]]);
        const Piece& piece = pieces_[pieces[i]];
        if (!fills(piece, window)) continue;
        const std::int32_t depth = greatest_depth(footprint(piece, window).greatest_key);
        if (piece.prim == first_prim) {
            first = std::min(first, depth);
        } else if (depth < first) {
            second = first;
            first = depth;
            first_prim = piece.prim;
        } else {
            second = std::min(second, depth);
        }
    }
    return second == never ? never : second >> cover_shift;
}

/// Unless the piece is hidden behind the cover, or no ray of the window meets it.
void CellBuilder::add_reference(
    std::vector<Reference>& references,
    std::uint32_t index,
    const Window& window,
    std::int32_t cover
) {
    const Piece& piece = pieces_[index];
    const auto is_hidden = [&](std::int32_t least) { return (least >> cover_shift) > cover; };
    if (cover != never && is_hidden(least_depth(static_cast<double>(Extremes(piece.key).least)))) {
        ++statistics_.culled;
        return;
    }
    const Footprint place = footprint(piece, window);
    if (place.least_u > place.greatest_u) return;
    const std::int32_t least = least_depth(place.least_key);
    if (is_hidden(least)) {
        ++statistics_.culled;
        return;
    }
    const SeenTriangle seen = edges_.see(piece, place, window);
    if (seen.edges.is_missed) return;
    references.push_back(
        {place, seen.depth, least, greatest_depth(place.greatest_key), seen.edges, index, piece.prim
        }
    );
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
                lists[static_cast<std::size_t>(row) * 4 + static_cast<std::size_t>(column)]
                    .push_back(reference.piece);
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
    }
    references.resize(kept);
}

void CellBuilder::add_list(std::vector<Reference>& references, Cell& cell) {
    if (is_radial_) merge_parts(references);
    const std::size_t count = references.size();
    if (count > ListHead::most_references) throw Error("pencil grid: too many triangles in a cell");
    order_.clear();
    for (std::uint32_t i = 0; i < count; ++i)
        order_.push_back({references[i].least, references[i].prim, i});
    std::sort(order_.begin(), order_.end());
    ++statistics_.leaves;
    statistics_.references += count;
    const std::size_t at = grow(list_bytes(count));
    cell.link = static_cast<std::uint32_t>(at / 16);
    const ListHead head{static_cast<std::uint32_t>(count)};
    std::byte* to = lists_.data() + at;
    std::memcpy(to, &head, sizeof head);
    to += sizeof head;
    for (std::size_t first = 0; first < count; first += chunk_size) {
        if (first > 0) {
            std::memcpy(to, &order_[first].least, chunk_head_bytes);
            to += chunk_head_bytes;
        }
        const std::size_t size = std::min(chunk_size, count - first);
        const std::size_t stride = padded(size);
        for (std::size_t i = 0; i < size; ++i) {
            const Reference& reference = references[order_[first + i].index];
            const auto put = [&](std::size_t row, auto value) {
                std::memcpy(to + 2 * row * stride + sizeof value * i, &value, sizeof value);
            };
            for (std::size_t row = 0; row < edge_rows; ++row)
                put(row, reference.edges.values[row]);
            const DepthRows depths = depth_rows(reference);
            put(depth_u, depths.u);
            put(depth_v, depths.v);
            put(depth_base, depths.base);
            put(prim_row, reference.prim);
            put(depth_shift, depths.shift);
        }
        to += chunk_bytes(size);
    }
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
    // Over a whole cell.
    const double steepest = 2 * std::max(std::abs(widest->plane.u), std::abs(widest->plane.v));
    const unsigned shift = shift_to(16000, steepest);
    if (shift > 14) return;
    const double unit = power_of_2(shift);
    const double whole_u = nearest(2 * widest->plane.u / unit);
    const double whole_v = nearest(2 * widest->plane.v / unit);
    const double slope_u = whole_u * unit;
    const double slope_v = whole_v * unit;
    double base = std::numeric_limits<double>::infinity();
    for (const Reference& reference : references) {
        const Span span(reference.place, window, pieces_[reference.piece].margin);
        const double start = slope_u * span.at_u + slope_v * span.at_v;
        const double level = reference.least - start - std::abs(slope_u) * span.half_u -
                             std::abs(slope_v) * span.half_v;
        double lowest = level;
        if (const DepthPlane& plane = reference.plane; plane.is_known) {
            const double middle = plane.at + plane.u * (2 * span.at_u - 1) +
                                  plane.v * (2 * span.at_v - 1) - plane.error;
            lowest = std::max(
                lowest,
                middle - start - std::abs(2 * plane.u - slope_u) * span.half_u -
                    std::abs(2 * plane.v - slope_v) * span.half_v
            );
        }
        base = std::min(base, lowest - (std::abs(slope_u) + std::abs(slope_v)) * span.off);
    }
    base = std::floor(base) - 2;
    if (!(base + 0.5 * (slope_u + slope_v) > cell.base) || !(std::abs(base) < 0x1p30)) return;
    cell.base = static_cast<std::int32_t>(base);
    cell.slope_u = static_cast<std::int16_t>(whole_u);
    cell.slope_v = static_cast<std::int16_t>(whole_v);
    cell.shift = shift & 0xFFU;
}

/// The plane of the triangle, or its least and greatest depth in the cell, whichever is closer.
CellBuilder::DepthRows CellBuilder::depth_rows(const Reference& reference) const {
    const Piece& piece = pieces_[reference.piece];
    const double least = piece.is_near ? 0 : reference.least;
    const double greatest = piece.is_near ? deepest : reference.greatest;
    const double middle = std::floor(0.5 * (least + greatest));
    const unsigned level_shift = std::max(least_shift, shift_to(depth_doubt, greatest - middle));
    const DepthRows level{
        0, 0, static_cast<std::int32_t>(middle), static_cast<std::uint8_t>(level_shift)
    };

    const DepthPlane& plane = reference.plane;
    if (!plane.is_known || piece.is_near) return level;
    const double steep = std::abs(plane.u) + std::abs(plane.v);
    // Rounding a slope takes off at most 1/2, rounding its product with a place as much: 2 in all.
    const unsigned shift =
        std::max({least_shift, shift_to(32000, steep), shift_to(depth_doubt - 2, plane.error + 1)});
    // Far from the triangle, its plane may be anywhere.
    if (shift >= level_shift || !(plane.at > -0x1p30 && plane.at < 0x1.fp30)) return level;
    const double steps = 1 / power_of_2(shift);
    return {
        static_cast<std::int16_t>(nearest(plane.u * steps)),
        static_cast<std::int16_t>(nearest(plane.v * steps)),
        static_cast<std::int32_t>(nearest(plane.at)),
        static_cast<std::uint8_t>(shift)
    };
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
