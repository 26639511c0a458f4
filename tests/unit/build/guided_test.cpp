// Each of the thesis's faults G1 to G9 (section 4.5) on the smallest input that shows it, in both
// modes; and the published build work, reproduced to the last digit.
#include <raywise/build/guided.hpp>

#include "unit/build/box_sets.hpp"

#include <raywise/bvh/statistics.hpp>
#include <raywise/bvh/validate.hpp>
#include <raywise/core/error.hpp>
#include <raywise/geometry/triangle.hpp>

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <random>
#include <vector>

namespace raywise {
namespace {

using namespace testing;

/// x is good, the others are not.
struct OnlyX {
    AxisRanking operator()(const Aabb&) const { return rank_axes(1, 0, 0); }
};

/// No axis of a box longer than 100 is good, every other axis is.
struct OnlySmall {
    AxisRanking operator()(const Aabb& box) const {
        return box.size().x > 100 ? rank_axes(0, 0, 0) : rank_axes(1, 1, 1);
    }
};

GuidedParams faithful_params() {
    GuidedParams params;
    params.faithful = true;
    return params;
}

GuidedParams corrected_params() {
    GuidedParams params;
    params.max_leaf_size = 1; // as small as the faithful leaves
    return params;
}

template <HitMeasure M = SurfaceMeasure, AxisPolicy P = AllAxes>
GuidedTree guide(
    const std::vector<Aabb>& boxes,
    const GuidedParams& params,
    const P& policy = {},
    const M& measure = {}
) {
    return build_guided(boxes, centers(boxes), measure, policy, params);
}

/// Two boxes that nearly fill their union, apart on every axis.
const std::vector<Aabb> overlapping_pair{cube({0, 0, 0}, 1), cube({0.1F, 0.1F, 0.1F}, 1)};

TEST(BuildGuided, TreeOverNoBoxesIsEmpty) {
    for (const bool faithful : {true, false}) {
        GuidedParams params;
        params.faithful = faithful;
        const GuidedTree result = guide({}, params);
        EXPECT_TRUE(result.tree.is_empty());
        EXPECT_EQ(result.report.axes_tried, 0U);
    }
}

TEST(BuildGuided, RefusesWhatItCannotBuild) {
    const std::vector<Aabb> boxes{cube({0, 0, 0}, 1)};
    EXPECT_THROW(static_cast<void>(build_guided(boxes, {}, SurfaceMeasure{}, AllAxes{})), Error);
    const std::vector<Vec3> bad{{std::numeric_limits<float>::infinity(), 0, 0}};
    EXPECT_THROW(static_cast<void>(build_guided(boxes, bad, SurfaceMeasure{}, AllAxes{})), Error);
    EXPECT_THROW(static_cast<void>(guide({Aabb{}}, {})), Error);
    EXPECT_THROW(static_cast<void>(guide(boxes, {.bin_count = 2})), Error);
    EXPECT_THROW(static_cast<void>(guide(boxes, {.quality_threshold = 1.5F})), Error);
    EXPECT_THROW(static_cast<void>(guide(boxes, {.total_mass = 0})), Error);
}

template <HitMeasure M>
void expect_valid_everywhere(const M& measure) {
    for (const BoxSet& set : pathological_sets()) {
        SCOPED_TRACE(set.name);
        for (const bool faithful : {true, false}) {
            GuidedParams params;
            params.faithful = faithful;
            for (const Bvh& tree :
                 {guide(set.boxes, params, LongestAxis{}, measure).tree,
                  guide(set.boxes, params, FacingAxis(SameDirection{{1, 0, 1}}), measure).tree}) {
                ASSERT_EQ(find_fault(tree, set.boxes), std::nullopt);
                EXPECT_TRUE(faithful || measure_tree(tree).largest_leaf <= 2);
            }
        }
    }
}

TEST(BuildGuided, PathologicalBoxesGiveValidTreesForSurfaceArea) {
    expect_valid_everywhere(SurfaceMeasure{});
}

TEST(BuildGuided, PathologicalBoxesGiveValidTreesForABlindMeasure) {
    expect_valid_everywhere(BlindMeasure{});
}

TEST(BuildGuided, PathologicalBoxesGiveValidTreesForAWindow) {
    expect_valid_everywhere(WindowMeasure{});
}

TEST(BuildGuided, G1RootTriesOneAxisWhateverItsRatio) {
    EXPECT_EQ(guide(overlapping_pair, faithful_params()).report.axes_tried, 1U);
    EXPECT_EQ(guide(overlapping_pair, corrected_params()).report.axes_tried, 3U);
}

TEST(BuildGuided, G2ForcedAxisReplacesABetterSplit) {
    // x parts a tall box from two small ones; y, which is longest, would put it with one of them.
    const std::vector<Aabb> boxes{
        {{0, 0, 0}, {1, 1, 10}}, {{8, 0, 0}, {9, 1, 1}}, {{8, 10, 0}, {9, 11, 1}}
    };
    const auto build = [&](GuidedParams params) {
        params.excellent_ratio = 0;
        params.acceptable_ratio = 0;
        return guide(boxes, params, OnlyX{});
    };
    const GuidedTree faithful = build(faithful_params());
    const GuidedTree corrected = build(corrected_params());
    EXPECT_EQ(faithful.tree[faithful.tree.root().left()].box(), unite(boxes[0], boxes[1]));
    EXPECT_EQ(corrected.tree[corrected.tree.root().left()].box(), boxes[0]);
    EXPECT_LT(
        tree_cost(corrected.tree, SurfaceMeasure{}), tree_cost(faithful.tree, SurfaceMeasure{})
    );
}

TEST(BuildGuided, G3ForcedSplitHandsDownProbabilitiesOfAnotherMetric) {
    // The root is forced, its two pairs are not.
    std::vector<Aabb> boxes = overlapping_pair;
    for (const Aabb& box : overlapping_pair)
        boxes.push_back({box.lo + Vec3{1000, 0, 0}, box.hi + Vec3{1000, 0, 0}});
    const auto axes = [&](GuidedParams params) {
        params.total_mass = 1e9; // so absolute probabilities are far below conditional ones
        return guide(boxes, params, OnlySmall{}).report.axes_tried;
    };
    // Faithful: a pair's ratio is its absolute probabilities over a conditional one: excellent.
    EXPECT_EQ(axes(faithful_params()), 1U + 1U + 1U);
    EXPECT_EQ(axes(corrected_params()), 1U + 3U + 3U);
}

TEST(BuildGuided, G4BlindMeasureMakesEveryRatioNan) {
    const std::vector<Aabb> boxes = series(4, [](float i) { return cube({10 * i, i, i}, 1); });
    GuidedParams params = faithful_params();
    // Below the root 0 / 0 is no ratio, so no early out works.
    const GuidedTree faithful = guide(boxes, params, AllAxes{}, BlindMeasure{});
    EXPECT_EQ(faithful.report.axes_tried, 1 + 3 * (faithful.report.inner_nodes - 1));
    const GuidedTree corrected = guide(boxes, corrected_params(), AllAxes{}, BlindMeasure{});
    const GuidedTree surface = guide(boxes, corrected_params());
    EXPECT_TRUE(same_bytes(corrected.tree, surface.tree));
    EXPECT_EQ(corrected.report.axes_tried, surface.report.axes_tried);
}

TEST(BuildGuided, G5ChildrenOfAnEarlierAxisBehaveLikeRoots) {
    // One far box; three tall ones that only x can part although y is longer.
    const std::vector<Aabb> boxes{
        {{0, 0, 0}, {1, 100, 1}},
        {{1, 0, 0}, {2, 100, 1}},
        {{10, 0, 0}, {11, 100, 1}},
        {{1000, 0, 0}, {1001, 100, 1}}
    };
    const auto report = [&](GuidedParams params) {
        params.excellent_ratio = 1e-30; // only a root's ratio is below
        params.acceptable_ratio = 1e-20;
        return guide(boxes, params, OnlyX{}).report;
    };
    // Root 1 axis; the three: x, forced y in vain; the two: 1 axis, like a root.
    EXPECT_EQ(report(faithful_params()).axes_tried, 1U + 2U + 1U);
    EXPECT_EQ(report(faithful_params()).forced_fallbacks, 1U);
    EXPECT_EQ(report(corrected_params()).axes_tried, 2U + 2U + 2U);
    EXPECT_EQ(report(corrected_params()).forced_fallbacks, 3U);
}

TEST(BuildGuided, G6ClusterInsideOneBinStaysOneLeaf) {
    std::vector<Aabb> boxes =
        series(10, [](float i) { return cube({500.1F + 0.05F * i, 500.1F, 500.1F}, 0.01F); });
    boxes.push_back({{0, 0, 0}, {1000, 1000, 1000}});
    EXPECT_EQ(measure_tree(guide(boxes, faithful_params()).tree).largest_leaf, 11U);
    EXPECT_EQ(measure_tree(guide(boxes, corrected_params()).tree).largest_leaf, 1U);
}

TEST(BuildGuided, G7TiesPeelOneBoxAfterTheOther) {
    const std::vector<Aabb> boxes = series(20, [](float i) { return cube({i, 0, 0}, 0.4F); });
    const auto depth = [&](const GuidedParams& params) {
        return measure_tree(guide(boxes, params, LongestAxis{}, ConstantMeasure{}).tree).max_depth;
    };
    EXPECT_EQ(depth(faithful_params()), 19);
    EXPECT_EQ(depth(corrected_params()), 5);
}

TEST(BuildGuided, G8OneBoxPerLeafWhateverItCosts) {
    GuidedParams params;
    EXPECT_EQ(guide(overlapping_pair, params).tree.nodes.size(), 1U);
    params.faithful = true;
    EXPECT_EQ(guide(overlapping_pair, params).tree.nodes.size(), 3U);
}

TEST(BuildGuided, G8LastPlaneIsNeverTried) {
    // Borders of bins at whole numbers; only the one at 39 lies between the centroids.
    const std::vector<Aabb> boxes{{{0, 0, 0}, {40, 1, 1}}, {{0, 0, 0}, {40, 1, 1}}};
    const std::vector<Vec3> centroids{{38.5F, 0, 0}, {39.5F, 0, 0}};
    const auto nodes = [&](const GuidedParams& params) {
        const OnlyX policy;
        return build_guided(boxes, centroids, SurfaceMeasure{}, policy, params).tree.nodes.size();
    };
    EXPECT_EQ(nodes(faithful_params()), 1U);
    EXPECT_EQ(nodes(corrected_params()), 3U);
}

TEST(BuildGuided, G9SurfaceAreaOverTheMassOfTheRaysSaturates) {
    const std::vector<Aabb> boxes = series(20, [](float i) { return cube({i, 0, 0}, 0.4F); });
    const auto build = [&](GuidedParams params) {
        params.max_measured_levels = 0;
        params.total_mass = 1e-6;
        return guide(boxes, params, OnlyX{}, ConstantMeasure{}).tree;
    };
    // Every probability is clamped to 1, every split costs the same, the first plane wins.
    EXPECT_EQ(measure_tree(build(faithful_params())).max_depth, 19);
    EXPECT_TRUE(
        same_bytes(build(corrected_params()), guide(boxes, corrected_params(), LongestAxis{}).tree)
    );
}

TEST(BuildGuided, StopRulesMakeLeavesEarly) {
    const std::vector<Aabb> boxes = soup(200, 0.1F);
    for (const bool faithful : {true, false}) {
        GuidedParams params = faithful ? faithful_params() : corrected_params();
        const auto shape = [&] { return measure_tree(guide(boxes, params).tree); };
        const TreeStatistics all = shape();
        params.max_levels = 4;
        EXPECT_EQ(shape().max_depth, 4);
        params.max_levels = 100;
        params.max_leaf_probability = 0.1;
        EXPECT_LT(shape().leaves, all.leaves);
        params.max_leaf_probability = 0;
        params.max_leaf_area = 0.5;
        EXPECT_LT(shape().leaves, all.leaves);
        params.max_leaf_area = 0;
        params.max_leaf_cost = 1;
        EXPECT_LT(shape().leaves, all.leaves);
    }
}

/// Numbers in [lo, hi) the way the thesis drew them: two words to a double, low word first.
class ThesisNumbers {
public:
    Vec3 vector(double lo, double hi) {
        Vec3 v;
        for (int axis = 0; axis < 3; ++axis)
            v[axis] = static_cast<float>(number() * (hi - lo) + lo);
        return v;
    }

private:
    double number() {
        const double low = static_cast<double>(words_());
        const double high = static_cast<double>(words_());
        return (low + high * 0x1p32) * 0x1p-64;
    }

    std::mt19937 words_{1};
};

struct Published {
    std::size_t triangles;
    float quality_threshold;
    std::optional<Vec3d> direction; ///< nothing: longest axes
    int levels;
    double cost_evaluations; ///< per inner node
    double axes_tried;       ///< per inner node
};

TEST(BuildGuided, ReproducesThePublishedBuildWorkOfSurfaceArea) {
    ThesisNumbers numbers;
    std::vector<Aabb> boxes[2];
    std::vector<Vec3> centroids[2];
    for (const int scene : {0, 1})
        for (int i = 0; i < (scene == 0 ? 100 : 1000); ++i) {
            Triangle t;
            t.v0 = numbers.vector(0, 10);
            t.v1 = t.v0 + numbers.vector(-1, 1);
            t.v2 = t.v1 + numbers.vector(-1, 1);
            boxes[scene].push_back(bounds(t));
            centroids[scene].push_back((t.v0 + t.v1 + t.v2) / 3.F);
        }
    const Vec3d along_z{0, 0, 1};
    const Vec3d tilted{0.259, 0, 0.966};
    const Vec3d diagonal{1, 0, 1};
    for (const Published& row :
         {Published{100, 0.99F, std::nullopt, 9, 55.535, 1.0303},
          Published{1000, 0.99F, std::nullopt, 12, 43.241, 1.0921},
          Published{100, 0.4F, along_z, 8, 55.051, 1.404},
          Published{1000, 0.4F, along_z, 13, 60.873, 1.7397},
          Published{100, 0.4F, tilted, 9, 56.101, 1.3737},
          Published{1000, 0.4F, tilted, 13, 58.859, 1.7487},
          Published{100, 0.4F, diagonal, 9, 39.091, 1.101},
          Published{1000, 0.4F, diagonal, 14, 36.266, 1.1692}}) {
        const int scene = row.triangles == 100 ? 0 : 1;
        GuidedParams params = faithful_params();
        params.max_leaf_size = 2;
        params.quality_threshold = row.quality_threshold;
        const auto build = [&](const auto& policy) {
            return build_guided(boxes[scene], centroids[scene], SurfaceMeasure{}, policy, params);
        };
        const GuidedTree result =
            row.direction ? build(FacingAxis(SameDirection{*row.direction})) : build(LongestAxis{});
        const auto inner = static_cast<double>(result.report.inner_nodes);
        EXPECT_EQ(measure_tree(result.tree).max_depth, row.levels);
        EXPECT_NEAR(
            static_cast<double>(result.report.cost_evaluations) / inner,
            row.cost_evaluations,
            0.0006
        );
        EXPECT_NEAR(static_cast<double>(result.report.axes_tried) / inner, row.axes_tried, 6e-5);
    }
}

} // namespace
} // namespace raywise
