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
    EXPECT_EQ(count_wrong_hits(oracle, rays, hits), 0U);
    const std::size_t i = some_hit();
    hits[i].t = std::nextafter(hits[i].t, 0.0F);
    EXPECT_EQ(count_wrong_hits(oracle, rays, hits), 1U);
    EXPECT_EQ(count_grossly_wrong_hits(oracle, rays, hits), 0U);
    hits[i] = {};
    EXPECT_EQ(count_wrong_hits(oracle, rays, hits), 1U);
    EXPECT_EQ(count_grossly_wrong_hits(oracle, rays, hits), 1U);
}

TEST_F(AnswerCheck, OcclusionsAreJudgedTheSameWay) {
    const auto occluded = std::make_unique<bool[]>(rays.size());
    for (std::size_t i = 0; i < rays.size(); ++i)
        occluded[i] = hits[i].prim != no_prim;
    const std::span<bool> answers(occluded.get(), rays.size());
    EXPECT_EQ(count_wrong_occlusions(oracle, rays, answers), 0U);
    answers[7] = !answers[7];
    answers[499] = !answers[499];
    EXPECT_EQ(count_wrong_occlusions(oracle, rays, answers, Executor(2)), 2U);
}

TEST_F(AnswerCheck, AsManyAnswersAsRaysAreNeeded) {
    hits.pop_back();
    EXPECT_THROW(static_cast<void>(count_wrong_hits(oracle, rays, hits)), Error);
    EXPECT_THROW(static_cast<void>(count_grossly_wrong_hits(oracle, rays, hits)), Error);
    EXPECT_THROW(static_cast<void>(count_wrong_occlusions(oracle, rays, {})), Error);
}

} // namespace
} // namespace raywise
