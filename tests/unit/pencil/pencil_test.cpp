#include <raywise/pencil/pencil.hpp>

#include <raywise/core/error.hpp>

#include <gtest/gtest.h>

#include <limits>

namespace raywise {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();

TEST(Pencil, RefusesWhatIsNotFiniteOrHasNoDirection) {
    EXPECT_THROW(static_cast<void>(Pencil::parallel({0, 0, 0})), Error);
    EXPECT_THROW(static_cast<void>(Pencil::parallel({0, infinity, 1})), Error);
    EXPECT_THROW(static_cast<void>(Pencil::radial({0, infinity, 1})), Error);
}

TEST(Pencil, HoldsItsShadowRaysAndTheRaysOfItsEmitterOnly) {
    const Pencil sun = Pencil::parallel({0.3F, -0.8F, 0.5F});
    EXPECT_TRUE(sun.holds(sun.shadow_ray({1, 2, 3})));
    EXPECT_TRUE(sun.holds({.origin = {7, 7, 7}, .direction = sun.direction()}));
    EXPECT_FALSE(sun.holds({.origin = {7, 7, 7}, .direction = sun.direction() * 2.5F}));

    const Pencil lamp = Pencil::radial({0.1F, 3, 0.7F});
    EXPECT_TRUE(lamp.holds(lamp.shadow_ray({1.3F, 2, 3})));
    EXPECT_TRUE(lamp.holds({.origin = lamp.apex(), .direction = {0.3F, 0.2F, 9}}));
    Ray beyond = lamp.shadow_ray({1.3F, 2, 3});
    beyond.t_max = 2;
    EXPECT_FALSE(lamp.holds(beyond));
}

TEST(Pencil, ShadowRaysEndAtTheEmitter) {
    EXPECT_EQ(Pencil::parallel({0, -1, 0}).shadow_ray({}).t_max, infinity);
    const Ray to_lamp = Pencil::radial({0, 4, 0}).shadow_ray({0, 1, 0}, 0.25F, PrimId{3});
    EXPECT_EQ(to_lamp.t_max, 1);
    EXPECT_EQ(to_lamp.t_min, 0.25F);
    EXPECT_EQ(to_lamp.excluded, PrimId{3});
    EXPECT_EQ(to_lamp.direction, (Vec3{0, 3, 0}));
}

} // namespace
} // namespace raywise
