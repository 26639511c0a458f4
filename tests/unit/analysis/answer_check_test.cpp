#include <raywise/analysis/answer_check.hpp>

#include <raywise/core/error.hpp>
#include <raywise/core/rng.hpp>
#include <raywise/geometry/sampling.hpp>
#include <raywise/scene/generate.hpp>

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <vector>

namespace raywise {
namespace {

class AnswerCheck : public ::testing::Test {
protected:
    AnswerCheck() {
        for (std::size_t i = 0; i < 500; ++i) {
            Rng rng(5, i);
            rays.push_back(
                {.origin = sample_box({{0, 0, 0}, {10, 10, 10}}, rng),
                 .direction = to_float(sample_sphere(rng))}
            );
        }
        hits.resize(rays.size());
        oracle.closest_hits(rays, hits);
    }

    /// The number of a ray that hits something.
    [[nodiscard]] std::size_t some_hit() const {
        std::size_t i = 0;
        while (hits[i].prim == no_prim)
            ++i;
        return i;
    }

    Scene scene = generate_random_triangles(300);
    ExactOracle oracle{scene.view()};
    std::vector<Ray> rays;
    std::vector<Hit> hits;
};

TEST_F(AnswerCheck, TheOracleAgreesWithBruteForce) {
    EXPECT_EQ(count_wrong_oracle_answers(oracle, scene.view(), rays, 500), 0U);
    EXPECT_EQ(count_wrong_oracle_answers(oracle, scene.view(), rays, 100'000), 0U);
    EXPECT_EQ(count_wrong_oracle_answers(oracle, scene.view(), {}, 10), 0U);
}

TEST_F(AnswerCheck, BruteForceOverOtherTrianglesContradictsTheOracle) {
    const Scene other = generate_random_triangles(300, 2);
    EXPECT_GT(count_wrong_oracle_answers(oracle, other.view(), rays, 500), 0U);
}

TEST_F(AnswerCheck, EveryWrongAnswerIsCounted) {
    std::vector<Hit> found = hits;
    EXPECT_EQ(count_wrong(hits, found), 0U);
    EXPECT_EQ(count_far_off(rays, hits, found), 0U);
    const std::size_t i = some_hit();
    found[i].t = std::nextafter(found[i].t, 0.0F);
    EXPECT_EQ(count_wrong(hits, found), 1U);
    EXPECT_EQ(count_far_off(rays, hits, found), 0U);
    found[i] = {};
    EXPECT_EQ(count_wrong(hits, found), 1U);
    EXPECT_EQ(count_far_off(rays, hits, found), 1U);
}

TEST_F(AnswerCheck, ATriangleAtTheSamePlaceIsNotFarOffButWrong) {
    std::vector<Hit> found = hits;
    found[some_hit()].prim = PrimId{299};
    EXPECT_EQ(count_wrong(hits, found), 1U);
    EXPECT_EQ(count_far_off(rays, hits, found), 0U);
    found[some_hit()].t *= 1.5F;
    EXPECT_EQ(count_far_off(rays, hits, found), 1U);
    EXPECT_EQ(count_far_off(rays, hits, found, 10), 0U);
}

TEST_F(AnswerCheck, OcclusionsOfTheOracleAreThoseOfItsClosestHits) {
    const auto occluded = std::make_unique<bool[]>(rays.size());
    const auto expected = std::make_unique<bool[]>(rays.size());
    const std::span<bool> answers(occluded.get(), rays.size());
    const std::span<bool> right(expected.get(), rays.size());
    oracle.any_hits(rays, answers, Executor(2));
    for (std::size_t i = 0; i < rays.size(); ++i)
        right[i] = hits[i].prim != no_prim;
    EXPECT_EQ(count_wrong(std::span<const bool>(right), std::span<const bool>(answers)), 0U);
    answers[7] = !answers[7];
    answers[499] = !answers[499];
    EXPECT_EQ(count_wrong(std::span<const bool>(right), std::span<const bool>(answers)), 2U);
}

TEST_F(AnswerCheck, AsManyAnswersAsRaysAreNeeded) {
    const std::span<const Hit> fewer = std::span<const Hit>(hits).subspan(1);
    EXPECT_THROW(static_cast<void>(count_wrong(hits, fewer)), Error);
    EXPECT_THROW(static_cast<void>(count_far_off(rays, hits, fewer)), Error);
    EXPECT_THROW(static_cast<void>(count_far_off(rays, fewer, hits)), Error);
    EXPECT_THROW(static_cast<void>(count_far_off(rays, hits, hits, 0)), Error);
}

} // namespace
} // namespace raywise
