// From a face's pieces to its top cells and lists.
#pragma once

#include "pencil/cell_builder.hpp"
#include "pencil/face_pieces.hpp"
#include "pencil/grid_data.hpp"

#include <raywise/core/executor.hpp>

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

namespace raywise::pencil_detail {

/// A face whose lists are still in parts.
struct BuiltFace {
    Face face; ///< `cells` not set
    std::vector<Cell> cells;
    std::vector<std::unique_ptr<CellBuilder>> parts; ///< of `part_cells` cells each
    std::size_t part_cells = 1;
    std::vector<Piece> pieces;
    std::size_t list_bytes = 0;
    PencilGridStatistics statistics{};
};

/// `coarsening`: cells are so many times larger than the parameters ask for. Nothing when the
/// references alone would exceed `most_references`.
[[nodiscard]] std::unique_ptr<BuiltFace> build_face(
    const std::vector<RawPiece>& pieces,
    const FaceMap& unscaled,
    const Records& records,
    bool is_radial,
    Vec3d apex,
    const PencilGridParams& params,
    double coarsening,
    std::size_t most_references,
    const Executor& executor
);

} // namespace raywise::pencil_detail
