#include <raywise/toplevel/region_index.hpp>

#include "support/random_regions.hpp"

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace raywise {
namespace {

using Areas = std::vector<AreaId>;

template <class Index>
Areas areas_at(const Index& index, Vec3 point) {
    Areas found;
    append_areas_at(index, point, found);
    std::sort(found.begin(), found.end());
    return found;
}

/// What the indices mean: every region is asked.
Areas brute_force(const std::vector<Region>& regions, Vec3 point) {
    Areas found;
    for (std::size_t i = 0; i < regions.size(); ++i) {
        if (contains(regions[i], to_double(point))) found.push_back(to_area(i));
    }
    return found;
}

/// Points all about, and on the planes where cells and boxes meet.
std::vector<Vec3> probes(const std::vector<Region>& regions, Rng& rng) {
    Aabb all;
    for (const Region& region : regions)
        all = unite(all, bounds(region));
    std::vector<Vec3> points;
    for (int i = 0; i < 300; ++i)
        points.push_back(to_float(test_support::random_point(rng, -9, 9)));
    // The center planes of the first three levels, in every combination, and the root's faces.
    for (int i = 0; i < 300; ++i) {
        Vec3 p = to_float(test_support::random_point(rng, -9, 9));
        for (int axis = 0; axis < 3; ++axis) {
            const auto part = static_cast<float>(rng.below(9)) / 8;
            if (rng.below(2) == 0) p[axis] = all.lo[axis] * (1 - part) + all.hi[axis] * part;
        }
        points.push_back(p);
    }
    for (const Region& region : regions) {
        const Aabb box = bounds(region);
        for (int i = 0; i < 8; ++i)
            points.push_back(box.vertex(i));
        if (const auto* obb = std::get_if<Obb>(&region)) {
            for (int i = 0; i < 8; ++i)
                points.push_back(to_float(vertex(*obb, i)));
            points.push_back(to_float(obb->center));
        }
        if (const auto* frustum = std::get_if<Frustum>(&region)) {
            points.push_back(to_float(frustum->eye));
        }
    }
    return points;
}

TEST(RegionIndex, AllKindsAgreeWithAskingEveryRegion) {
    for (std::uint64_t seed = 0; seed < 40; ++seed) {
        Rng rng(7, seed);
        const auto regions = test_support::random_regions(rng, 1 + rng.below(20));
        const RegionList list(regions);
        const RegionBvh bvh(regions);
        std::vector<RegionOctree> octrees;
        for (const int level : {0, 1, 4, 5}) {
            octrees.emplace_back(regions, OctreeParams{.max_level = level});
        }
        for (const Vec3 point : probes(regions, rng)) {
            const Areas expected = brute_force(regions, point);
            ASSERT_EQ(areas_at(list, point), expected) << "seed " << seed;
            ASSERT_EQ(areas_at(bvh, point), expected) << "seed " << seed;
            for (const RegionOctree& octree : octrees) {
                ASSERT_EQ(areas_at(octree, point), expected)
                    << "seed " << seed << " level " << octree.params().max_level;
            }
        }
    }
}

TEST(RegionIndex, AgreesFarFromTheOriginAndAtAnyScale) {
    for (std::uint64_t seed = 0; seed < 30; ++seed) {
        Rng rng(8, seed);
        const double scale = std::exp2(rng.uniform(-40, 40));
        const Vec3d away = test_support::random_direction(rng) * (scale * 1000);
        std::vector<Region> regions;
        for (int i = 0; i < 6; ++i) {
            Obb box = test_support::random_obb(rng);
            box.center = box.center * scale + away;
            box.half = box.half * scale;
            regions.emplace_back(box);
        }
        const RegionOctree octree(regions);
        const RegionBvh bvh(regions);
        for (int i = 0; i < 500; ++i) {
            const Vec3 point = to_float(test_support::random_point(rng, -8, 8) * scale + away);
            const Areas expected = brute_force(regions, point);
            ASSERT_EQ(areas_at(octree, point), expected) << "seed " << seed;
            ASSERT_EQ(areas_at(bvh, point), expected) << "seed " << seed;
        }
    }
}

TEST(RegionIndex, OverNoRegionsFindsNothing) {
    const std::vector<Region> none;
    for (const auto kind : {RegionIndexKind::list, RegionIndexKind::octree, RegionIndexKind::bvh}) {
        const AnyRegionIndex index = build_region_index(none, {.kind = kind});
        int found = 0;
        visit_areas_at(index, {0, 0, 0}, [&](AreaId) { ++found; });
        EXPECT_EQ(found, 0);
    }
    EXPECT_EQ(RegionOctree(none).measure_statistics().levels, 0);
}

TEST(RegionIndex, NotANumberAndInfinityAreNowhere) {
    const std::vector<Region> regions{Aabb{{-1, -1, -1}, {1, 1, 1}}};
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const float infinity = std::numeric_limits<float>::infinity();
    for (const auto kind : {RegionIndexKind::list, RegionIndexKind::octree, RegionIndexKind::bvh}) {
        const AnyRegionIndex index = build_region_index(regions, {.kind = kind});
        for (const Vec3 point : {Vec3{nan, 0, 0}, Vec3{0, nan, 0}, Vec3{0, 0, infinity}}) {
            visit_areas_at(index, point, [&](AreaId) { ADD_FAILURE(); });
        }
    }
}

TEST(RegionIndex, FlatRegionsAndPointsContainThemselves) {
    const std::vector<Region> regions{
        Aabb{{0, 0, 0}, {1, 0, 1}},
        Aabb{{0.5F, 0, 0.5F}, {0.5F, 0, 0.5F}},
        Obb{{0.5, 0, 0.5}, {}, {0.5, 0, 0.5}}
    };
    const Areas all{AreaId{0}, AreaId{1}, AreaId{2}};
    EXPECT_EQ(areas_at(RegionOctree(regions), {0.5F, 0, 0.5F}), all);
    EXPECT_EQ(areas_at(RegionBvh(regions), {0.5F, 0, 0.5F}), all);
    EXPECT_EQ(areas_at(RegionList(regions), {0.5F, 0, 0.5F}), all);
    EXPECT_TRUE(areas_at(RegionOctree(regions), {0.5F, 1e-30F, 0.5F}).empty());
}

TEST(RegionIndex, ChoosesAListForFewAndATreeForMany) {
    Rng rng(9);
    EXPECT_TRUE(
        std::holds_alternative<RegionList>(build_region_index(test_support::random_regions(rng, 8)))
    );
    EXPECT_TRUE(
        std::holds_alternative<RegionBvh>(build_region_index(test_support::random_regions(rng, 9)))
    );
}

TEST(RegionOctree, OverTakesMoreAndUnderFewerThanTheTruth) {
    Rng rng(10);
    const auto regions = test_support::random_regions(rng, 12);
    const RegionOctree over(regions, {.max_level = 4, .mode = OctreeMode::over});
    const RegionOctree under(regions, {.max_level = 4, .mode = OctreeMode::under});
    std::size_t extra = 0;
    std::size_t missing = 0;
    for (const Vec3 point : probes(regions, rng)) {
        const Areas truth = brute_force(regions, point);
        const Areas more = areas_at(over, point);
        const Areas fewer = areas_at(under, point);
        ASSERT_TRUE(std::includes(more.begin(), more.end(), truth.begin(), truth.end()));
        ASSERT_TRUE(std::includes(truth.begin(), truth.end(), fewer.begin(), fewer.end()));
        extra += more.size() - truth.size();
        missing += truth.size() - fewer.size();
    }
    EXPECT_GT(extra, 0U);
    EXPECT_GT(missing, 0U);
}

TEST(RegionOctree, ARegionThatIsTheRootNeedsOneCell) {
    const std::vector<Region> regions{Aabb{{0, 0, 0}, {4, 2, 1}}};
    const OctreeStatistics seen = RegionOctree(regions).measure_statistics();
    EXPECT_EQ(seen.nodes, 1U);
    EXPECT_EQ(seen.leaves, 1U);
    EXPECT_EQ(seen.levels, 1);
    EXPECT_EQ(seen.mean_list_length, 1);
    EXPECT_EQ(seen.over_error.at(0), 0);
    EXPECT_EQ(seen.under_error.at(0), 0);
}

TEST(RegionOctree, CellsOfTwoCornerBoxesAreThoseCountedByHand) {
    // Root [0, 4]^3. The boxes are its lowest and highest children exactly; closed sets touch, so
    // all eight children cross one box at least and are divided at level 1, and so on down.
    const std::vector<Region> regions{Aabb{{0, 0, 0}, {2, 2, 2}}, Aabb{{2, 2, 2}, {4, 4, 4}}};
    const OctreeStatistics one = RegionOctree(regions, {.max_level = 1}).measure_statistics();
    EXPECT_EQ(one.nodes, 9U);
    EXPECT_EQ(one.leaves, 8U);
    EXPECT_EQ(one.levels, 2);
    EXPECT_EQ(one.max_list_length, 2U);
    // Each box: its own cell contains it; the seven others touch it.
    EXPECT_DOUBLE_EQ(one.mean_list_length, 2);
    EXPECT_DOUBLE_EQ(one.over_error.at(0), 7);
    EXPECT_DOUBLE_EQ(one.under_error.at(0), 0);
}

TEST(RegionOctree, FullTreesHaveTheCorrectedNumberOfNodes) {
    // A diagonal plane crosses cells on every level; no tree exceeds (8^L - 1) / 7 nodes.
    const std::vector<Region> regions{Obb{{0, 0, 0}, frame_along({1, 1, 1}), {4, 4, 1e-3}}};
    std::size_t full = 1;
    std::size_t level_nodes = 1;
    for (int level = 0; level <= 5; ++level) {
        const auto seen = RegionOctree(regions, {.max_level = level}).measure_statistics();
        EXPECT_LE(seen.nodes, full);
        EXPECT_EQ(seen.levels, level + 1);
        EXPECT_EQ(seen.leaves, (seen.nodes * 7 + 1) / 8);
        level_nodes *= 8;
        full += level_nodes;
    }
}

TEST(RegionOctree, FinerCellsComeCloserToTheRegions) {
    Rng rng(11);
    const std::vector<Region> regions{
        test_support::random_frustum(rng), Obb{{0, 0, 0}, frame_along({1, 2, 3}), {2, 1, 3}}
    };
    double before = std::numeric_limits<double>::infinity();
    double below = -2;
    for (int level = 1; level <= 6; ++level) {
        const auto seen = RegionOctree(regions, {.max_level = level}).measure_statistics();
        EXPECT_LE(seen.over_error.at(1), before);
        EXPECT_GE(seen.under_error.at(1), below);
        EXPECT_GE(seen.over_error.at(1), 0);
        EXPECT_LE(seen.under_error.at(1), 0);
        before = seen.over_error.at(1);
        below = seen.under_error.at(1);
    }
    EXPECT_LT(before, 0.2);
}

TEST(RegionOctree, RefusesLevelsOutOfRange) {
    const std::vector<Region> regions{Aabb{{0, 0, 0}, {1, 1, 1}}};
    EXPECT_THROW(RegionOctree(regions, {.max_level = -1}), Error);
    EXPECT_THROW(RegionOctree(regions, {.max_level = 11}), Error);
}

} // namespace
} // namespace raywise
