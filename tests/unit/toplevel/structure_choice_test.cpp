#include <raywise/toplevel/structure_choice.hpp>

#include <gtest/gtest.h>

namespace raywise {
namespace {

const std::vector<StructurePrediction> predictions{
    {StructureKind::none, 0, 100},
    {StructureKind::pencil_grid, 1'000'000, 20},
    {StructureKind::wide_tree, 2'000'000, 90}
};

TEST(StructureChoice, BuildsOnlyWhenEnoughRaysWillEarnItBack) {
    EXPECT_EQ(cheapest(predictions, 0).kind, StructureKind::none);
    EXPECT_EQ(cheapest(predictions, 12'000).kind, StructureKind::none);
    EXPECT_EQ(cheapest(predictions, 12'500).kind, StructureKind::none); // a tie goes to the first
    EXPECT_EQ(cheapest(predictions, 13'000).kind, StructureKind::pencil_grid);
}

TEST(StructureChoice, ExplanationNamesCandidatesAndWhereTheyPay) {
    const std::string text = explain(
        {.kind = StructureKind::pencil_grid,
         .expected_rays = 1e6,
         .predictions = predictions,
         .remark = "checked on 256 rays"}
    );
    EXPECT_EQ(
        text,
        "pencil_grid, cheapest for 1e+06 rays\n"
        "  none: build 0 ns, 100 ns per ray, total 100 ms\n"
        "  pencil_grid: build 1 ms, 20 ns per ray, total 21 ms, pays from 1.25e+04 rays\n"
        "  wide_tree: build 2 ms, 90 ns per ray, total 92 ms, pays from 2e+05 rays\n"
        "  checked on 256 rays"
    );
}

} // namespace
} // namespace raywise
