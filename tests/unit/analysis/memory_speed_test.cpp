#include <raywise/analysis/memory_speed.hpp>

#include <gtest/gtest.h>

#include <cmath>

namespace raywise {
namespace {

TEST(MeasureLoad, TakesLongerWhereTheCachesEnd) {
    const double in_cache = measure_load_ns(16U << 10U);
    const double beyond = measure_load_ns(256U << 20U);
    EXPECT_GT(in_cache, 0);
    EXPECT_GT(beyond, 2 * in_cache);
    EXPECT_LT(beyond, 1e5);
}

TEST(MeasureSpeed, OfNothingIsThatOfAPage) {
    EXPECT_GT(measure_load_ns(0), 0);
    EXPECT_TRUE(std::isfinite(measure_load_ns(0)));
    EXPECT_GT(measure_stream_gb_per_s(0), 0);
    EXPECT_TRUE(std::isfinite(measure_stream_gb_per_s(0)));
}

TEST(MeasureStream, IsFasterThanDependentLoadsOfTheSameBytes) {
    constexpr std::size_t bytes = 64U << 20U;
    const double bytes_per_ns_by_loads = 64 / measure_load_ns(bytes);
    EXPECT_GT(measure_stream_gb_per_s(bytes), bytes_per_ns_by_loads);
}

} // namespace
} // namespace raywise
