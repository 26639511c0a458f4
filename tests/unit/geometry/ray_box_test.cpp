#include <raywise/geometry/ray_box.hpp>

#include "support/exact_oracle.hpp"

#include <raywise/core/rng.hpp>
#include <raywise/geometry/aabb.hpp>
#include <raywise/geometry/ray.hpp>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

namespace raywise {
namespace {

constexpr float infinity = std::numeric_limits<float>::infinity();
constexpr float nan = std::numeric_limits<float>::quiet_NaN();

/// Whether each slab test that may be used for the ray accepts the box.
bool all_slabs_hit(const Ray& ray, const Aabb& box) {
    const bool wide = WideSlab(ray)(box, static_cast<double>(ray.t_max)).hit;
    return wide && (needs_wide_slab(ray) || Slab(ray)(box, ray.t_max).hit);
}

bool some_slab_hits(const Ray& ray, const Aabb& box) {
    const bool wide = WideSlab(ray)(box, static_cast<double>(ray.t_max)).hit;
    return wide || (!needs_wide_slab(ray) && Slab(ray)(box, ray.t_max).hit);
}

TEST(RayBox, IntervalIsWhereTheRayIsInside) {
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_EQ(intersect(Ray{{-3, 0, 0}, {2, 0, 0}}, box), (Interval{1, 2}));
    EXPECT_EQ(intersect(Ray{{0, 0, 0}, {0, 0, -2}}, box), (Interval{0, 0.5F})); // inside: t_min
    EXPECT_EQ(intersect(Ray{{-3, 0, 0}, {2, 0, 0}, 1.5F, 1.75F}, box), (Interval{1.5F, 1.75F}));
    EXPECT_EQ(intersect(Ray{{-3, 0, 0}, {2, 0, 0}, 2.5F, 9}, box), std::nullopt);
    EXPECT_EQ(intersect(Ray{{-3, 0, 0}, {2, 0, 0}, 0, 0.5F}, box), std::nullopt);
    EXPECT_EQ(intersect(Ray{{-3, 0, 0}, {-2, 0, 0}}, box), std::nullopt);
    EXPECT_EQ(intersect(Ray{{-3, 2, 0}, {2, 0, 0}}, box), std::nullopt);
}

TEST(RayBox, NothingIsHitByInvalidRaysOrInEmptyBoxes) {
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_EQ(intersect(Ray{{nan, 0, 0}, {1, 0, 0}}, box), std::nullopt);
    EXPECT_EQ(intersect(Ray{{0, 0, 0}, {0, 0, 0}}, box), std::nullopt);
    EXPECT_EQ(intersect(Ray{{0, 0, 0}, {1, 0, 0}, 2, 1}, box), std::nullopt);
    EXPECT_EQ(intersect(Ray{{0, 0, 0}, {1, 0, 0}}, Aabb{{nan, -1, -1}, {1, 1, 1}}), std::nullopt);
    for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{-1, -0.0F, 0}, Vec3{1, -2, 3}}) {
        EXPECT_EQ(intersect(Ray{{0, 0, 0}, d}, Aabb{}), std::nullopt);
        EXPECT_FALSE(some_slab_hits({{0, 0, 0}, d}, Aabb{}));
    }
}

/// One axis of a ray and a box, with the exact interval of t that it allows.
struct AxisCase {
    float origin, direction, lo, hi;
    bool never = false;  ///< parallel and outside
    bool always = false; ///< parallel and between the faces
    mpq_class entry, exit;
};

AxisCase axis_case(float o, float d, float lo, float hi) {
    AxisCase c{o, d, lo, hi, false, false, {}, {}};
    const auto rational = [](float x) { return mpq_class(static_cast<double>(x)); };
    if (d == 0) {
        (lo <= o && o <= hi ? c.always : c.never) = true;
        return c;
    }
    c.entry = (rational(lo) - rational(o)) / rational(d);
    c.exit = (rational(hi) - rational(o)) / rational(d);
    if (d < 0) swap(c.entry, c.exit);
    return c;
}

template <class Values>
std::vector<AxisCase> axis_cases(const Values& points, const Values& directions) {
    std::vector<AxisCase> cases;
    for (const float o : points)
        for (const float d : directions)
            for (const float lo : points)
                for (const float hi : points)
                    if (lo <= hi) cases.push_back(axis_case(o, d, lo, hi));
    return cases;
}

struct Oracle {
    bool hit;     ///< the ray meets the box at some t >= 0
    bool is_sure; ///< not by a hair: doubles must agree
    mpq_class entry, exit;
};

Oracle meet(const std::array<const AxisCase*, 3>& axes) {
    Oracle result{true, true, 0, mpq_class(mpz_class(1) << 2000)};
    for (const AxisCase* axis : axes) {
        if (axis->never) return {false, true, {}, {}};
        if (axis->always) continue;
        if (axis->entry > result.entry) result.entry = axis->entry;
        if (axis->exit < result.exit) result.exit = axis->exit;
    }
    result.hit = result.entry <= result.exit;
    const mpq_class slack = abs(result.exit) * mpq_class(0x1p-50);
    result.is_sure = abs(result.exit - result.entry) > slack;
    return result;
}

void check(const std::array<const AxisCase*, 3>& axes, Rng& rng) {
    const auto& [x, y, z] = axes;
    const Ray ray{{x->origin, y->origin, z->origin}, {x->direction, y->direction, z->direction}};
    const Aabb box{{x->lo, y->lo, z->lo}, {x->hi, y->hi, z->hi}};
    if (!is_valid(ray)) return;
    const Oracle exact = meet(axes);
    const auto interval = intersect(ray, box);
    if (exact.is_sure) {
        ASSERT_EQ(interval.has_value(), exact.hit);
    }
    if (interval && exact.is_sure) {
        const float entry = oracle::nearest_float(exact.entry);
        const float exit = oracle::nearest_float(exact.exit);
        ASSERT_TRUE(
            interval->entry == entry || interval->entry == std::nextafter(entry, 0.0F) ||
            interval->entry == std::nextafter(entry, infinity)
        );
        ASSERT_TRUE(
            interval->exit == exit || interval->exit == std::nextafter(exit, 0.0F) ||
            interval->exit == std::nextafter(exit, infinity)
        );
    }
    if (!exact.hit) return;
    // Intervals that end or begin exactly where the ray enters or leaves.
    const float entry = oracle::nearest_float(exact.entry);
    const float exit = oracle::nearest_float(exact.exit);
    const float inside = std::isinf(exit) ? entry : entry + (exit - entry) * rng.uniform();
    for (const auto& [t_min, t_max] : std::array<std::array<float, 2>, 5>{
             {{0, infinity}, {0, entry}, {exit, infinity}, {inside, inside}, {entry, exit}}
         }) {
        Ray part = ray;
        part.t_min = t_min;
        part.t_max = t_max;
        if (!is_valid(part) || std::isinf(t_min)) continue;
        ASSERT_TRUE(all_slabs_hit(part, box))
            << "o " << ray.origin.x << ' ' << ray.origin.y << ' ' << ray.origin.z << " d "
            << ray.direction.x << ' ' << ray.direction.y << ' ' << ray.direction.z << " t " << t_min
            << ' ' << t_max;
    }
}

TEST(RayBox, SpecialValuesOnAllAxesAgreeWithRationalArithmetic) {
    // Every combination: 54 cases on each of three axes.
    const std::array<float, 3> points{-1, 0, 1};
    const std::array<float, 3> directions{-1, -0.0F, 1};
    const std::vector<AxisCase> cases = axis_cases(points, directions);
    ASSERT_EQ(cases.size(), 54U);
    Rng rng(1);
    for (const AxisCase& x : cases)
        for (const AxisCase& y : cases)
            for (const AxisCase& z : cases) {
                check({&x, &y, &z}, rng);
                if (HasFatalFailure()) return;
            }
}

TEST(RayBox, ExtremeValuesOnEachAxisAgreeWithRationalArithmetic) {
    constexpr float denormal = 0x1p-149F;
    constexpr float largest = std::numeric_limits<float>::max();
    const std::array<float, 14> points{
        -0x1p60F,
        -3,
        -1,
        -0x1p-126F,
        -denormal,
        -0.0F,
        0,
        denormal,
        0x1p-120F,
        0.1F,
        1,
        1.0000001F,
        7,
        0x1p60F
    };
    const std::array<float, 14> directions{
        -largest,
        -1,
        -0x1p-127F,
        -denormal,
        -0.0F,
        0,
        denormal,
        0x1p-126F,
        0.3F,
        1,
        3,
        0x1p126F,
        0x1p127F,
        largest
    };
    const std::vector<AxisCase> cases = axis_cases(points, directions);
    Rng rng(2);
    const auto any = [&] { return &cases[static_cast<std::size_t>(rng.below(cases.size()))]; };
    for (const AxisCase& one : cases)
        for (int i = 0; i < 4; ++i) {
            std::array<const AxisCase*, 3> axes{any(), any(), any()};
            axes[static_cast<std::size_t>(i % 3)] = &one;
            check(axes, rng);
            if (HasFatalFailure()) return;
        }
    // Partners that never narrow: the axis alone decides.
    const AxisCase open = axis_case(0, 0, -1, 1);
    for (const AxisCase& one : cases) {
        check({&one, &open, &open}, rng);
        check({&open, &open, &one}, rng);
        if (HasFatalFailure()) return;
    }
}

TEST(RayBox, TraversalFormRefusesWhatIsMissedByMoreThanRounding) {
    int refused = 0;
    for (std::uint64_t i = 0; i < 20000; ++i) {
        Rng rng(3, i);
        const auto vec = [&] {
            return Vec3{rng.uniform() - 0.5F, rng.uniform() - 0.5F, rng.uniform() - 0.5F};
        };
        const Ray ray{vec(), vec()};
        const Aabb box = unite(unite(Aabb{}, vec()), vec());
        if (intersect(ray, box)) continue;
        const Aabb wider{box.lo - Vec3{1e-5F, 1e-5F, 1e-5F}, box.hi + Vec3{1e-5F, 1e-5F, 1e-5F}};
        if (intersect(ray, wider)) continue;
        ++refused;
        ASSERT_FALSE(some_slab_hits(ray, box)) << i;
    }
    EXPECT_GT(refused, 5000);
}

TEST(RayBox, TraversalEntryIsTheKeyOfOrder) {
    const Aabb box{{-1, -1, -1}, {1, 1, 1}};
    EXPECT_EQ(Slab(Ray{{-3, 0, 0}, {2, 0, 0}})(box, infinity).entry, 1);
    EXPECT_EQ(Slab(Ray{{0, 0, 0}, {2, 0, 0}, 0.25F})(box, infinity).entry, 0.25F);
    EXPECT_EQ(WideSlab(Ray{{-3, 0, 0}, {2, 0, 0}})(box, 9).entry, 1);
}

} // namespace
} // namespace raywise
