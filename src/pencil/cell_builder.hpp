// From the pieces that touch a cell to its list, or to its sixteen children.
#pragma once

#include "pencil/edge_lines.hpp"
#include "pencil/footprint.hpp"
#include "pencil/grid_data.hpp"
#include "pencil/piece.hpp"

#include <raywise/pencil/pencil_grid_params.hpp>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace raywise::pencil_detail {

/// Builds cells one after another; their lists and children go to `lists()`. Links count from its
/// start until `shift_links` moves them.
class CellBuilder {
public:
    CellBuilder(
        const FaceMap& map,
        bool is_radial,
        std::span<const Piece> pieces,
        const EdgeLines& edges,
        const PencilGridParams& params
    )
        : map_(map), is_radial_(is_radial), pieces_(pieces), edges_(edges), params_(params) {}

    /// The top cell of the window, from all pieces that may touch it, in any order.
    [[nodiscard]] Cell build(std::span<const std::uint32_t> pieces, const Window& window) {
        return build(pieces, window, top_shift);
    }

    [[nodiscard]] const std::vector<std::byte>& lists() const { return lists_; }

    /// Writes the lists to `to`, links moved by `words` times 16 bytes.
    void write(std::byte* to, std::uint32_t words) const;

    [[nodiscard]] const PencilGridStatistics& statistics() const { return statistics_; }

private:
    struct Reference {
        Footprint place{};
        DepthPlane plane;
        std::int32_t least = 0;    ///< depth, in units
        std::int32_t greatest = 0; ///< depth, in units
        EdgeRows edges;
        std::uint32_t piece = 0;
        PrimId prim = no_prim;
    };

    /// A reference's depths as a list has them.
    struct DepthRows {
        std::int16_t u, v;
        std::int32_t base;
        std::uint8_t shift;
    };

    /// Where a reference stands in its list.
    struct Place {
        std::int32_t least;
        PrimId prim;
        std::uint32_t index;

        friend auto operator<=>(const Place&, const Place&) = default;
    };

    Cell build(std::span<const std::uint32_t> pieces, const Window& window, int shift);
    void set_near(Cell& cell, const std::vector<Reference>& references, const Window& window) const;
    [[nodiscard]] DepthRows depth_rows(const Reference& reference) const;
    [[nodiscard]] std::int32_t least_depth(double key) const;
    [[nodiscard]] std::int32_t greatest_depth(double key) const;
    [[nodiscard]] std::int32_t
    cover_of(std::span<const std::uint32_t> pieces, const Window& window) const;
    void add_reference(
        std::vector<Reference>& references,
        std::uint32_t index,
        const Window& window,
        std::int32_t cover
    );
    [[nodiscard]] bool
    split(const std::vector<Reference>& references, const Window& window, int shift, Cell& cell);
    void add_list(std::vector<Reference>& references, Cell& cell);
    void merge_parts(std::vector<Reference>& references) const;
    [[nodiscard]] std::size_t grow(std::size_t bytes);

    const FaceMap& map_;
    bool is_radial_;
    std::span<const Piece> pieces_;
    const EdgeLines& edges_;
    const PencilGridParams& params_;
    std::vector<std::byte> lists_;
    std::vector<Place> order_;                         ///< of the list being written
    std::vector<std::size_t> splits_;                  ///< where children are
    std::array<std::vector<Reference>, 5> references_; ///< by level
    std::array<std::array<std::vector<std::uint32_t>, children>, 5> child_pieces_; ///< by level
    PencilGridStatistics statistics_;
};

} // namespace raywise::pencil_detail
