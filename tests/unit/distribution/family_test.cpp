// One statistical test for every family: sampler, density and hit measure say the same.
#include "support/statistics.hpp"

#include <raywise/distribution/distribution.hpp>
#include <raywise/distribution/monte_carlo.hpp>
#include <raywise/geometry/sampling.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace raywise {
namespace {

using testing::agrees;
using testing::RunningMean;

/// A ray of a law that covers the tested one, and its density in the tested one's unit.
struct ReferenceRay {
    Ray ray;
    double density = 1;
};

struct Family {
    std::string name;
    Distribution distribution;
    std::function<ReferenceRay(Rng&)> reference; ///< empty: no density to integrate
    double bias = 0;                             ///< documented error of the measure, absolute
    Vec3d focus; ///< where special boxes are put: the eye, or the middle of the window

    friend void PrintTo(const Family& family, std::ostream* out) { *out << family.name; }
};

const Vec3d eye{0.25, -0.5, 0.125};

/// The density of a radial law is that of the direction, wherever on its line the ray starts.
Family radial(std::string name, RadialParams params, double bias = 0) {
    params.eye = eye;
    const auto all_around = [radius = params.radius](Rng& rng) {
        const Vec3d shift = sample_sphere(rng) * (radius * std::cbrt(rng.uniform_double()));
        return ReferenceRay{
            {.origin = to_float(eye + shift), .direction = to_float(sample_sphere(rng))},
            1 / (4 * std::numbers::pi)
        };
    };
    return {std::move(name), RadialDistribution(params), all_around, bias, eye};
}

/// Starts on a rectangle a little larger than the window, in a cone a little wider.
Family parallel(std::string name, const ParallelParams& params, double bias = 0) {
    const double wide = 1.25;
    const double cone = wide * params.cone_half_angle_deg * std::numbers::pi / 180;
    const Vec3d middle = params.point + params.frame.forward * params.start_depth;
    const auto reference = [=](Rng& rng) {
        const double x = rng.uniform(-wide, wide) * params.half_width;
        const double y = rng.uniform(-wide, wide) * params.half_height;
        const Vec3d start = middle + params.frame.right * x + params.frame.up * y;
        const double per_area = 1 / (4 * wide * wide * params.half_width * params.half_height);
        const double per_sr = cone > 0 ? 1 / cap_solid_angle_sr(cone) : 1;
        const Vec3d direction = sample_cap(params.frame, cone, rng);
        return ReferenceRay{
            {.origin = to_float(start), .direction = to_float(direction)}, per_area * per_sr
        };
    };
    return {std::move(name), ParallelDistribution(params), reference, bias, middle};
}

/// Lines through a sphere around the bounds: a direction, and a point of the disk across it.
Family uniform(std::string name, const Aabb& bounds) {
    const Vec3d middle = to_double(bounds.center());
    const auto reference = [=](Rng& rng) {
        const double radius = length(to_double(bounds.size())) / 2;
        const Frame frame = frame_along(sample_sphere(rng));
        const Vec2d at = sample_disk(radius, rng);
        const Vec3d start =
            middle + frame.right * at.x + frame.up * at.y - frame.forward * (2 * radius);
        const double per_area = 1 / (std::numbers::pi * radius * radius);
        return ReferenceRay{
            {.origin = to_float(start), .direction = to_float(frame.forward)},
            per_area / (4 * std::numbers::pi)
        };
    };
    return {std::move(name), UniformDistribution(bounds), reference, 0, middle};
}

Family measured(std::string name, double shrinkage) {
    const ParallelDistribution source(
        {.frame = frame_along({1, 2, 3}), .half_width = 2, .half_height = 1}
    );
    MeasuredParams params{.rays = {}, .bounds = {{-2, -2, -2}, {2, 2, 2}}, .shrinkage = shrinkage};
    for (std::uint64_t i = 0; i < 200; ++i) {
        Rng rng(3, i);
        Ray ray = source.sample(rng);
        ray.t_max = 3 * rng.uniform();
        params.rays.push_back({ray, rng.uniform_double()});
    }
    return {std::move(name), MeasuredDistribution(params), {}, 0, {}};
}

std::vector<Family> families() {
    const Frame oblique = frame_along({0.3, -0.8, 0.5});
    const auto fov = window_of_fov;
    return {
        uniform("Uniform", {{-1, -0.5F, -1}, {1, 2, 1}}),
        uniform("UniformOnPlate", {{-1, 0.5F, -1}, {1, 0.5F, 1}}),
        parallel("ParallelAlongAxis", {.half_width = 1.5, .half_height = 1}),
        parallel(
            "ParallelOblique",
            {.point = {0.5, 1, -1}, .frame = oblique, .half_width = 1, .half_height = 2}
        ),
        parallel("ParallelFromDepth", {.frame = oblique, .start_depth = 1.5}),
        parallel("ParallelInNarrowCone", {.frame = oblique, .cone_half_angle_deg = 2}, 0.01),
        parallel("ParallelInWideCone", {.half_width = 2, .cone_half_angle_deg = 30}, 0.02),
        radial("Pinhole", {.window = fov(60, 90), .emission = Emission::pinhole}),
        radial(
            "PinholeFromNearPlane",
            {.frame = oblique,
             .window = fov(120, 50),
             .emission = Emission::pinhole,
             .start_depth = 0.75}
        ),
        radial(
            "IsotropicInWindow",
            {.frame = oblique, .window = fov(100, 70), .emission = Emission::isotropic}
        ),
        radial(
            "IsotropicFromNearPlane",
            {.window = fov(60, 60), .emission = Emission::isotropic, .start_depth = 0.5}
        ),
        radial("IsotropicAllAround", {.emission = Emission::isotropic}),
        radial("YawPitch", {.window = fov(90, 90), .emission = Emission::yaw_pitch}),
        radial(
            "YawPitchFromNearPlane",
            {.frame = oblique,
             .window = fov(130, 45),
             .emission = Emission::yaw_pitch,
             .start_depth = 0.5}
        ),
        radial("LampAllAround", {.emission = Emission::isotropic, .radius = 0.05}, 0.07),
        radial(
            "LampInWindow",
            {.frame = oblique,
             .window = fov(90, 60),
             .emission = Emission::isotropic,
             .radius = 0.05},
            0.07
        ),
        measured("Measured", 0),
        measured("MeasuredWithShrinkage", 50)
    };
}

Aabb around(Vec3d center, Vec3d half) {
    return {to_float(center - half), to_float(center + half)};
}

/// Boxes of sizes from 0.01 to 3, each side flat with probability 1/8, at points of drawn rays and
/// of their continuation backward: inside, at borders, behind, around the start. First the special
/// ones.
std::vector<Aabb> boxes_for(const Family& family, std::size_t count) {
    std::vector<Aabb> boxes{
        around(family.focus, {0.5, 0.5, 0.5}),
        around(family.focus, {4, 4, 4}),
        around(family.focus, {3, 0.25, 3}),
        around(family.focus, {0.1, 5, 0.1}),
        around(family.focus + Vec3d{100, 0, 0}, {0.01, 0.01, 0.01}),
    };
    for (std::uint64_t i = 0; boxes.size() < count; ++i) {
        Rng rng(17, i);
        const Ray ray = sample(family.distribution, rng);
        const auto reach = static_cast<double>(std::min(ray.t_max, 4.0F));
        const Vec3d at =
            to_double(ray.origin) + to_double(ray.direction) * rng.uniform(-0.25 * reach, reach);
        Vec3d half;
        for (int axis = 0; axis < 3; ++axis)
            half[axis] = rng.below(8) == 0 ? 0 : 0.005 * std::pow(300, rng.uniform_double());
        boxes.push_back(around(at, half));
    }
    return boxes;
}

class EveryFamily : public ::testing::TestWithParam<Family> {};

TEST_P(EveryFamily, MeetsABoxAsOftenAsTheMeasureSays) {
    const Family& family = GetParam();
    std::size_t partly = 0;
    for (const Aabb& box : boxes_for(family, 80)) {
        const double exact = hit_probability(family.distribution, box);
        ASSERT_GE(exact, 0);
        ASSERT_LE(exact, 1);
        const auto draw = [&family](Rng& rng) { return sample(family.distribution, rng); };
        const ShareEstimate sampled =
            count_share(FunctionRef<Ray(Rng&)>(draw), box, {.samples = 20'000, .seed = 5});
        EXPECT_TRUE(agrees(sampled, exact, family.bias))
            << "box " << box.lo.x << ' ' << box.lo.y << ' ' << box.lo.z << " to " << box.hi.x << ' '
            << box.hi.y << ' ' << box.hi.z;
        if (exact > 0.01 && exact < 0.99) ++partly;
    }
    EXPECT_GT(partly, 15U) << "the boxes are too trivial to tell anything";
}

/// A property of a ray's line: on which side of a plane its direction is, on which side of a value
/// its moment about an axis.
struct LineEvent {
    Vec3d direction_axis;
    double direction_limit;
    Vec3d moment_axis;
    double moment_limit;

    explicit LineEvent(Rng rng)
        : direction_axis(sample_sphere(rng))
        , direction_limit(rng.uniform(-1, 1))
        , moment_axis(sample_sphere(rng))
        , moment_limit(rng.uniform(-1, 1)) {}

    bool operator()(const Ray& ray) const {
        const Vec3d direction = normalized(to_double(ray.direction));
        const Vec3d moment = cross(to_double(ray.origin), direction);
        return dot(direction, direction_axis) > direction_limit ||
               dot(moment, moment_axis) > moment_limit;
    }
};

TEST_P(EveryFamily, DensityIntegratesToOneAndToTheShareOfSamplesWithAnyProperty) {
    const Family& family = GetParam();
    if (!family.reference) GTEST_SKIP() << "a discrete law has no density";
    for (std::uint64_t k = 0; k < 12; ++k) {
        const LineEvent event(Rng(41, k));
        RunningMean total;
        RunningMean difference;
        for (std::uint64_t i = 0; i < 20'000; ++i) {
            Rng rng(11, i);
            const ReferenceRay drawn = family.reference(rng);
            const double weight = density(family.distribution, drawn.ray) / drawn.density;
            const Ray ray = sample(family.distribution, rng);
            total.add(weight);
            difference.add((event(drawn.ray) ? weight : 0) - (event(ray) ? 1 : 0));
        }
        ASSERT_TRUE(agrees(total, 1));
        // Rounding to float can push the samples of a pencil that lies in the event's border over.
        EXPECT_TRUE(agrees(difference, 0, 1e-5)) << "event " << k;
    }
}

TEST_P(EveryFamily, DensityIsPositiveAtDrawnRays) {
    const Family& family = GetParam();
    if (!family.reference) GTEST_SKIP() << "a shrunk record draws chords that it did not record";
    std::size_t zero = 0;
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng rng(23, i);
        if (!(density(family.distribution, sample(family.distribution, rng)) > 0)) ++zero;
    }
    EXPECT_EQ(zero, 0U);
}

TEST_P(EveryFamily, MeasureGrowsWithTheBox) {
    const Family& family = GetParam();
    std::uint64_t i = 0;
    for (const Aabb& inner : boxes_for(family, 300)) {
        Rng rng(29, i++);
        Aabb outer = inner;
        // Some faces move out, by a little or a lot.
        for (int axis = 0; axis < 3; ++axis) {
            if (rng.below(2) == 0) outer.lo[axis] -= std::pow(10.0F, 4 * rng.uniform() - 4);
            if (rng.below(2) == 0) outer.hi[axis] += std::pow(10.0F, 4 * rng.uniform() - 4);
        }
        const double small = hit_probability(family.distribution, inner);
        EXPECT_LE(small, hit_probability(family.distribution, outer) + 1e-6);
    }
}

TEST_P(EveryFamily, EmptyBoxHasMeasureZero) {
    EXPECT_EQ(hit_probability(GetParam().distribution, Aabb{}), 0);
}

TEST_P(EveryFamily, SamplesAreValidRaysAndRepeat) {
    const Family& family = GetParam();
    for (std::uint64_t i = 0; i < 1000; ++i) {
        Rng once(31, i);
        Rng again(31, i);
        const Ray ray = sample(family.distribution, once);
        const Ray twin = sample(family.distribution, again);
        EXPECT_TRUE(is_valid(ray));
        EXPECT_TRUE(ray.origin == twin.origin && ray.direction == twin.direction);
    }
}

INSTANTIATE_TEST_SUITE_P(
    Distribution,
    EveryFamily,
    ::testing::ValuesIn(families()),
    [](const ::testing::TestParamInfo<Family>& family) { return family.param.name; }
);

} // namespace
} // namespace raywise
