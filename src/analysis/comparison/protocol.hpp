// How a comparison builds its trees and draws its rays: ours, or the thesis's when it is faithful.
#pragma once

#include <raywise/analysis/comparison.hpp>
#include <raywise/distribution/influence_area.hpp>
#include <raywise/toplevel/accelerator.hpp>
#include <raywise/toplevel/build_tree.hpp>
#include <raywise/toplevel/membership.hpp>

namespace raywise::detail {

/// The variant that the others are measured against.
[[nodiscard]] Variant baseline_of(const CompareParams& params);

/// How the global tree is built.
[[nodiscard]] Heuristic global_heuristic(const CompareParams& params);

/// Which triangles an area's tree is built over.
[[nodiscard]] MembershipParams membership_of(const CompareParams& params);

/// The structure whose local trees are the baseline's.
[[nodiscard]] AcceleratorParams baseline_structure(const CompareParams& params);

/// The area as the run sees it: for faithful runs, radial areas with a window emit by yaw and
/// pitch.
[[nodiscard]] InfluenceArea prepared(InfluenceArea area, const CompareParams& params);

} // namespace raywise::detail
