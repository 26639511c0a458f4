// Tests of wide trees on every instruction set of this machine.
#pragma once

#include <raywise/trace/wide.hpp>

#include <gtest/gtest.h>

#include <string>
#include <string_view>

namespace raywise::test_support {

/// The parameter is the name of one of `simd_targets()`, on which the test runs.
class OnSimdTarget : public testing::TestWithParam<std::string_view> {
protected:
    void SetUp() override { force_simd_target(GetParam()); }

    void TearDown() override { force_simd_target(""); }
};

inline std::string name_of_target(const testing::TestParamInfo<std::string_view>& target) {
    return std::string(target.param);
}

} // namespace raywise::test_support
