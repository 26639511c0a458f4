#include <raywise/core/progress.hpp>

#include <gtest/gtest.h>

#include <cstdint>
#include <stop_token>
#include <string>
#include <string_view>

namespace raywise {
namespace {

TEST(Progress, ByDefaultReportsToNobodyAndNeverStops) {
    EXPECT_NO_THROW(Progress{}.step("any", 1, 2));
}

TEST(Progress, ReportsEachStepAndStopsOnRequest) {
    std::stop_source source;
    std::string seen;
    const Progress progress{
        [&](std::string_view stage, std::uint64_t done, std::uint64_t total) {
            seen += std::string(stage) + std::to_string(done) + "/" + std::to_string(total) + " ";
        },
        source.get_token()
    };
    progress.step("build", 1, 2);
    source.request_stop();
    EXPECT_THROW(progress.step("build", 2, 2), Cancelled);
    EXPECT_EQ(seen, "build1/2 ");
}

} // namespace
} // namespace raywise
