// Which structure answers an area's rays at the least total cost: what it takes to build, and what
// every ray takes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace raywise {

/// What the rays of an influence area are traced through.
enum class StructureKind : std::uint8_t {
    none,        ///< nothing of its own: the global tree
    binary_tree, ///< a binary tree over the region's triangles, to be watched node by node
    wide_tree,   ///< a wide tree over the region's triangles, built for the area's rays
    framed_tree, ///< a wide tree over all triangles, its boxes in the sheared frame of the area's
                 ///< rays; parallel areas only
    pencil_grid, ///< a pencil grid over all triangles; exact areas only
    /// Nothing is built: a batch of exact rays is gridded itself, and the triangles are drawn over
    /// it; single rays go to the global tree. Exact areas only.
    inversion,
};

/// "none", "binary_tree", "wide_tree", "framed_tree", "pencil_grid" or "inversion".
[[nodiscard]] std::string_view name_of(StructureKind kind);

/// What a caller knows of an area's future.
struct AreaUse {
    /// Over the life of the accelerator; >= 0. Absent: ten for every triangle of the scene.
    std::optional<double> expected_rays = {};
    /// Forced; absent: the cheapest in total by prediction. An area that is not exact can have no
    /// pencil grid and no inversion, one that is not parallel no framed tree: Error.
    std::optional<StructureKind> structure = {};
};

/// What one structure would cost. Nanoseconds of one core of a usual processor, by the constants of
/// docs/performance.md: ratios count.
struct StructurePrediction {
    StructureKind kind = StructureKind::none;
    double build_ns = 0;
    double ray_ns = 0;

    [[nodiscard]] double total_ns(double rays) const { return build_ns + rays * ray_ns; }
};

/// The decision for one area, and what it was made of.
struct StructureChoice {
    StructureKind kind = StructureKind::none;
    bool is_forced = false;
    double expected_rays = 0;
    std::vector<StructurePrediction> predictions; ///< of all that were considered, `none` first
    std::string remark; ///< what a sampled check or a limit changed; often empty
};

/// The prediction with the least total; ties go to the first. `predictions` must not be empty.
[[nodiscard]] StructurePrediction
cheapest(const std::vector<StructurePrediction>& predictions, double rays);

/// A few lines for people: what was chosen, for how many rays, the predicted costs of each
/// candidate and the number of rays from which the chosen one beats the global tree.
[[nodiscard]] std::string explain(const StructureChoice& choice);

} // namespace raywise
