// The author's own scenes must give the author's own numbers: docs/reproduction.md.
#include <raywise/analysis/comparison.hpp>
#include <raywise/scene/generate.hpp>

#include <gtest/gtest.h>

#include <array>
#include <stdexcept>

namespace raywise {
namespace {

/// What [Falcone24] publishes of a tree, without rays.
struct Published {
    Variant variant;
    double estimated_sah;
    double estimated_pah;
    double evaluations_per_node;
    int depth;
};

constexpr Variant pah_facing{Variant::Measure::area, Variant::Axes::facing};
constexpr Variant sah_facing{Variant::Measure::surface, Variant::Axes::facing};
constexpr Variant pah_longest{Variant::Measure::area, Variant::Axes::longest};
constexpr Variant sah_longest{Variant::Measure::surface, Variant::Axes::longest};

/// The plane area parallel to z over Random100 and Random1000.
Comparison run(const Scene& scene) {
    const InfluenceArea area = InfluenceArea::plane(
        "parallel",
        {.point = {5, 5, -4}, .normal = {0, 0, 1}, .half_width = 5, .half_height = 5, .depth = 20}
    );
    return compare(scene, std::array{area}, faithful_params());
}

const ComparisonRow& row_of(const Comparison& comparison, Variant variant) {
    for (const ComparisonRow& row : comparison.rows) {
        if (row.variant == variant) return row;
    }
    throw std::logic_error("no such row");
}

void expect(const Comparison& comparison, const Published& published) {
    const ComparisonRow& row = row_of(comparison, published.variant);
    SCOPED_TRACE(name_of(row.variant));
    EXPECT_NEAR(row.estimated_cost_sah, published.estimated_sah, 5e-5);
    // The published program computes areas in float.
    EXPECT_NEAR(row.estimated_cost, published.estimated_pah, 3e-5 * published.estimated_pah);
    EXPECT_NEAR(
        static_cast<double>(row.build_work.cost_evaluations) /
            static_cast<double>(row.build_work.inner_nodes),
        published.evaluations_per_node,
        1e-3
    );
    EXPECT_EQ(row.depth, published.depth);
}

TEST(Reproduction, OfRandom100IsExactToThePublishedDigits) {
    const Comparison comparison = run(generate_random_triangles(100, 1));
    expect(comparison, {pah_facing, 21.8697, 13.0394, 67.636, 9});
    expect(comparison, {sah_facing, 20.7095, 14.0213, 55.051, 8});
    expect(comparison, {pah_longest, 20.5564, 16.9748, 63.515, 11});
    expect(comparison, {sah_longest, 19.0733, 21.0795, 55.535, 9});
}

TEST(Reproduction, OfRandom1000IsExactForSurfaceAreaAndLongestAxis) {
    const Comparison comparison = run(generate_random_triangles(1000, 1, 100));
    const ComparisonRow& row = row_of(comparison, sah_longest);
    EXPECT_NEAR(row.estimated_cost_sah, 69.5885, 5e-5);
    EXPECT_EQ(row.depth, 12);
}

TEST(Reproduction, OfRealCostsStaysWithinTheNoiseOfAThousandRays) {
    const Comparison comparison = run(generate_random_triangles(100, 1));
    const std::array published{12.9652, 14.0169, 16.7092, 21.2848};
    for (std::size_t i = 0; i < published.size(); ++i) {
        EXPECT_NEAR(comparison.rows[i].real_cost.mean, published[i], 0.1 * published[i]);
    }
}

} // namespace
} // namespace raywise
