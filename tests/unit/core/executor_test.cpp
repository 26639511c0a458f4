#include <raywise/core/executor.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <thread>
#include <vector>

namespace raywise {
namespace {

TEST(Executor, RefusesThreadCountsOutOfRange) {
    EXPECT_THROW(Executor(-1), Error);
    EXPECT_THROW(Executor(1025), Error);
    EXPECT_GE(Executor(0).threads(), 1);
}

TEST(Executor, ChunksCoverEveryIndexOnceForAnyThreadCount) {
    for (const int threads : {1, 2, 5})
        for (const std::size_t count : {0U, 1U, 9U, 10U, 11U, 1000U}) {
            std::vector<std::atomic<int>> visits(count);
            Executor(threads).for_each_chunk(count, 10, [&](std::size_t begin, std::size_t end) {
                EXPECT_EQ(begin % 10, 0U);
                EXPECT_LE(end - begin, 10U);
                for (std::size_t i = begin; i < end; ++i)
                    ++visits[i];
            });
            for (const auto& visit : visits)
                EXPECT_EQ(visit, 1);
        }
}

TEST(Executor, InvokeNests) {
    const Executor executor(3);
    std::atomic<int> leaves = 0;
    const auto descend = [&](const auto& self, int depth) -> void {
        if (depth == 0)
            ++leaves;
        else
            executor.invoke([&] { self(self, depth - 1); }, [&] { self(self, depth - 1); });
    };
    descend(descend, 8);
    EXPECT_EQ(leaves, 256);
}

TEST(Executor, SerialWorkStaysInTheCaller) {
    const auto caller = std::this_thread::get_id();
    serial_executor().invoke(
        [&] { EXPECT_EQ(std::this_thread::get_id(), caller); },
        [&] { EXPECT_EQ(std::this_thread::get_id(), caller); }
    );
}

TEST(Executor, AnExceptionOfATaskReachesTheCaller) {
    for (const int threads : {1, 4})
        EXPECT_THROW(
            Executor(threads).for_each_chunk(
                100,
                1,
                [](std::size_t begin, std::size_t) {
                    if (begin == 42) throw std::runtime_error("task");
                }
            ),
            std::runtime_error
        );
}

} // namespace
} // namespace raywise
