#include <raywise/analysis/comparison.hpp>

#include <raywise/core/error.hpp>
#include <raywise/scene/generate.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace raywise {
namespace {

/// Parallel rays along z through the random triangles of [0, 10]^3.
InfluenceArea sun() {
    return InfluenceArea::plane(
        "sun",
        {.point = {5, 5, -4}, .normal = {0, 0, 1}, .half_width = 5, .half_height = 5, .depth = 20}
    );
}

InfluenceArea eye() {
    return InfluenceArea::point(
        "eye",
        {.eye = {5, 5, -4},
         .direction = {0, 0, 1},
         .fov_x_deg = 60,
         .fov_y_deg = 60,
         .near = 1,
         .far = 20}
    );
}

CompareParams quick() {
    CompareParams params;
    params.rays = 300;
    params.seeds = 3;
    params.repeats = 0;
    params.brute_force_budget = 1e5;
    return params;
}

TEST(Compare, RefusesWhatItCannotCompare) {
    const Scene scene = generate_random_triangles(20);
    const std::vector<InfluenceArea> areas{sun()};
    EXPECT_THROW((void)compare(Scene{}, areas, quick()), Error);
    EXPECT_THROW((void)compare(scene, {}, quick()), Error);
    CompareParams params = quick();
    params.rays = 0;
    EXPECT_THROW((void)compare(scene, areas, params), Error);
    params = quick();
    params.seeds = 0;
    EXPECT_THROW((void)compare(scene, areas, params), Error);
    params = quick();
    params.faithful = true; // with variants that the thesis does not know
    EXPECT_THROW((void)compare(scene, areas, params), Error);
}

TEST(Compare, FindsNoMismatchAndReportsARowPerAreaAndVariant) {
    const Scene scene = generate_random_triangles(300);
    const std::vector<InfluenceArea> areas{sun(), eye()};
    const Comparison comparison = compare(scene, areas, quick());
    EXPECT_EQ(comparison.mismatches, 0U);
    EXPECT_EQ(comparison.triangles, 300U);
    ASSERT_EQ(comparison.areas.size(), 2U);
    ASSERT_EQ(comparison.rows.size(), 2 * comparison.params.variants.size());
    for (const ComparisonRow& row : comparison.rows) {
        EXPECT_GT(row.triangles, 200U) << name_of(row.variant);
        EXPECT_GT(row.nodes, 0U);
        EXPECT_GT(row.real_cost.mean, 0);
        EXPECT_LE(row.ordered_cost.mean, row.real_cost.mean + 0.5);
        EXPECT_LE(row.any_hit_cost.mean, row.ordered_cost.mean);
        EXPECT_GE(row.overlap, 0);
        EXPECT_LE(row.overlap, 1 + 1e-6);
        EXPECT_LE(row.break_even_hit_fraction.value_or(0), 10);
    }
    for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(comparison.areas[i].checked_by_brute_force, 300U);
        EXPECT_NE(verdict_text(comparison, i).find("use "), std::string::npos);
        EXPECT_EQ(comparison.rows[comparison.areas[i].winner].area, i);
    }
}

TEST(Compare, MeasuresTheBaselineAgainstItself) {
    const Scene scene = generate_random_triangles(100);
    const Comparison comparison = compare(scene, std::vector{sun()}, quick());
    std::size_t baselines = 0;
    for (const ComparisonRow& row : comparison.rows) {
        if (!row.is_baseline) continue;
        ++baselines;
        EXPECT_EQ(row.variant, strong_baseline);
        EXPECT_DOUBLE_EQ(row.ordered_ratio.mean, 1);
        EXPECT_DOUBLE_EQ(row.ordered_ratio.half_width, 0);
    }
    EXPECT_EQ(baselines, 1U);
}

TEST(Compare, PredictsTheCostOfTheAreasOwnRays) {
    const Scene scene = generate_random_triangles(300);
    CompareParams params = quick();
    params.rays = 4000;
    for (const ComparisonRow& row : compare(scene, std::vector{sun(), eye()}, params).rows) {
        EXPECT_NEAR(row.real_cost.mean, row.estimated_cost, 0.05 * row.estimated_cost)
            << row.area << name_of(row.variant);
        EXPECT_LT(row.estimate_error, 0.05);
    }
}

TEST(Compare, CountsTheSameOnAnyNumberOfThreads) {
    const Scene scene = generate_random_triangles(200);
    const std::vector<InfluenceArea> areas{eye()};
    const Comparison one = compare(scene, areas, quick());
    const Comparison two = compare(scene, areas, quick(), Executor(2));
    for (std::size_t i = 0; i < one.rows.size(); ++i) {
        EXPECT_EQ(one.rows[i].real_cost.mean, two.rows[i].real_cost.mean);
        EXPECT_EQ(one.rows[i].full_cost.mean, two.rows[i].full_cost.mean);
        EXPECT_EQ(one.rows[i].overlap, two.rows[i].overlap);
        EXPECT_EQ(one.rows[i].end_point_overlap, two.rows[i].end_point_overlap);
    }
}

TEST(Compare, TimesOnlyWhenAsked) {
    const Scene scene = generate_random_triangles(50);
    CompareParams params = quick();
    params.variants = {strong_baseline, {Variant::Measure::area, Variant::Axes::all}};
    params.repeats = 2;
    const Comparison timed = compare(scene, std::vector{sun()}, params);
    for (const ComparisonRow& row : timed.rows) {
        EXPECT_GT(row.ns_per_ray.mean, 0);
        EXPECT_GT(row.full_ns.mean, 0);
        EXPECT_GT(row.build_ms, 0);
    }
    EXPECT_EQ(timed.mismatches, 0U);
    params.repeats = 0;
    EXPECT_EQ(compare(scene, std::vector{sun()}, params).rows[1].ns_per_ray.mean, 0);
}

TEST(Compare, AnAreaWithoutTrianglesHasNoLocalTreeAndNoMismatch) {
    const Scene scene = generate_random_triangles(50);
    const InfluenceArea nowhere = InfluenceArea::plane(
        "nowhere",
        {.point = {500, 5, 5}, .normal = {1, 0, 0}, .half_width = 5, .half_height = 5, .depth = 20}
    );
    const Comparison comparison = compare(scene, std::vector{nowhere}, quick());
    EXPECT_EQ(comparison.mismatches, 0U);
    EXPECT_EQ(comparison.rows.front().nodes, 0U);
    EXPECT_NE(comparison.areas.front().verdict, AreaSummary::Verdict::local_structure);
}

TEST(Compare, FaithfulRunsTheFourPairsOfTheThesis) {
    const Scene scene = generate_random_triangles(100);
    const Comparison comparison = compare(scene, std::vector{sun(), eye()}, faithful_params());
    ASSERT_EQ(comparison.rows.size(), 8U);
    for (const ComparisonRow& row : comparison.rows) {
        EXPECT_GT(row.build_work.cost_evaluations, 0U);
        EXPECT_GT(row.restart_cost, row.real_cost.mean);
    }
    EXPECT_EQ(comparison.mismatches, 0U);
}

TEST(Variants, HaveNames) {
    EXPECT_EQ(name_of(strong_baseline), "SAH/all");
    EXPECT_EQ(name_of({Variant::Measure::area, Variant::Axes::facing}), "PAH/facing");
    EXPECT_EQ(name_of({Variant::Measure::mixed, Variant::Axes::all}), "PAH+SAH/all");
    EXPECT_EQ(name_of({Variant::Measure::counted, Variant::Axes::longest}), "RAYS/longest");
}

} // namespace
} // namespace raywise
