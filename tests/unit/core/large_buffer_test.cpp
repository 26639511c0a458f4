#include <raywise/core/large_buffer.hpp>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <new>

namespace raywise {
namespace {

TEST(LargeBuffer, HoldsWhatIsWrittenWhateverItsSize) {
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{1} << 20U}) {
        const LargeBuffer<std::uint64_t> buffer(count);
        EXPECT_EQ(reinterpret_cast<std::uintptr_t>(buffer.get()) % 64, 0U);
        for (std::size_t i = 0; i < count; ++i)
            buffer[i] = i * i;
        for (std::size_t i = 0; i < count; i += 1000)
            EXPECT_EQ(buffer[i], i * i);
    }
}

TEST(LargeBuffer, RefusesWhatNoMemoryHolds) {
    EXPECT_THROW(static_cast<void>(allocate_large(static_cast<std::size_t>(-1))), std::bad_alloc);
}

} // namespace
} // namespace raywise
