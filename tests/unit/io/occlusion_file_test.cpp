// Oracle: the bytes that numpy 1.24 writes for the same array.
#include <raywise/io/occlusion_file.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <iterator>

namespace raywise {
namespace {

std::string written(std::span<const std::uint8_t> flags) {
    const std::string path = testing::TempDir() + "raywise_occlusion_test.npy";
    save_occlusion(path, flags);
    std::ifstream file(path, std::ios::binary);
    std::string bytes{std::istreambuf_iterator<char>(file), {}};
    std::remove(path.c_str());
    return bytes;
}

TEST(SaveOcclusion, WritesWhatNumpyWrites) {
    const std::array<std::uint8_t, 3> flags = {1, 0, 255};
    std::string expected("\x93NUMPY\x01\x00\x76\x00", 10);
    expected += "{'descr': '|b1', 'fortran_order': False, 'shape': (3,), }";
    expected += std::string(127 - expected.size(), ' ') + "\n" + std::string("\x01\x00\x01", 3);
    EXPECT_EQ(written(flags), expected);
}

TEST(SaveOcclusion, OfNoRaysIsAnEmptyArray) {
    const std::string bytes = written({});
    EXPECT_EQ(bytes.size() % 64, 0U);
    EXPECT_NE(bytes.find("'shape': (0,)"), std::string::npos);
}

} // namespace
} // namespace raywise
