#include "identify/estimate/repeats.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace treacle::identify {
namespace {

constexpr double truth = 2.3; // ln of 10 Pa s

// A run against clips of one set-up: in each clip the liquid flows as if its viscosity were another one.
EvaluatedRun run_at(double x, const std::vector<double>& clips, double noise) {
    constexpr int frames = 8, segments = 8;
    std::mt19937 generator{5};
    std::normal_distribution<double> normal(0, noise);
    EvaluatedRun out;
    out.point = Eigen::VectorXd::Constant(1, x);
    for (const double clip : clips) {
        auto& residuals = out.experiments.emplace_back();
        for (int f = 0; f < frames; ++f) {
            for (int s = 0; s < segments; ++s) {
                const double angle = 2 * std::numbers::pi * s / segments;
                SegmentResidual one;
                one.frame = f;
                one.time = 0.03 * f;
                one.x = 100 + 50 * std::cos(angle);
                one.y = 100 + 50 * std::sin(angle);
                one.points = 25;
                one.displacement = -20 * std::max(0.0, std::cos(angle)) * f / frames * (x - clip) + normal(generator);
                residuals.segments.push_back(one);
            }
        }
    }
    return out;
}

std::vector<EvaluatedRun> runs_against(const std::vector<double>& clips, double noise = 0.2) {
    std::vector<EvaluatedRun> out;
    for (const double x : {1.9, 2.1, 2.25, 2.35, 2.5}) out.push_back(run_at(x, clips, noise));
    return out;
}

std::vector<ViewInformation> priors(std::size_t clips) {
    return std::vector<ViewInformation>(clips, ViewInformation::Identity() * 1e12);
}

TEST(BetweenClips, IsTheVarianceOfTheMeanOfClipsThatDiffer) {
    const std::vector<double> clips{2.2, 2.3, 2.4};
    const auto found = between_clips(runs_against(clips, 1e-3), priors(3), {0, 0, 0});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->variance[0], 0.01 / 3, 0.02 * 0.01 / 3); // s^2 / k
    EXPECT_EQ(found->freedom, 2);
    EXPECT_NEAR(found->mean[0], 2.3, 1e-3);
}

TEST(BetweenClips, IsUnknownForOneClipEach) {
    EXPECT_FALSE(between_clips(runs_against({2.2, 2.3}), priors(2), {0, 1}));
    EXPECT_FALSE(between_clips({}, {}, {}));
}

TEST(BetweenClips, SetUpsOfOneClipAreTakenToScatterAsTheOthersDo) {
    const auto found = between_clips(runs_against({2.2, 2.4, 2.3, 2.3}, 1e-3), priors(4), {0, 0, 2, 3});
    ASSERT_TRUE(found);
    EXPECT_NEAR(found->variance[0], 0.02 / 4, 0.1 * 0.02 / 4); // s^2 of the two over four clips
    EXPECT_EQ(found->freedom, 1);
}

// 90 % intervals over made-up studies of four clips, each 5 % another viscosity: with the clips' part they hold the truth, without it they
// hardly ever do.
TEST(BetweenClips, EntersIntervalsThatHoldTheTruth) {
    constexpr int studies = 60;
    int inside = 0, inside_without = 0;
    std::mt19937 generator{7};
    std::normal_distribution<double> normal(0, 0.05);
    for (int i = 0; i < studies; ++i) {
        std::vector<double> clips(4);
        for (auto& one : clips) one = truth + normal(generator);
        const auto runs = runs_against(clips, 0.05);
        auto found = estimate(runs, priors(4));
        inside_without += std::abs(found.point[0] - truth) <
                          ninety_percent(found.parts[0], found.freedom[0]) * std::sqrt(found.parts[0].total());
        const auto scatter = between_clips(runs, priors(4), {0, 0, 0, 0});
        ASSERT_TRUE(scatter);
        found.parts[0].clips = scatter->variance[0];
        found.parts[0].clip_freedom = scatter->freedom;
        found.point += scatter->shift;
        inside += std::abs(found.point[0] - truth) <
                  ninety_percent(found.parts[0], found.freedom[0]) * std::sqrt(found.parts[0].total());
    }
    // Three standard deviations of the count below 54.
    EXPECT_GE(inside, 47);
    EXPECT_LT(inside_without, 30);
}

} // namespace
} // namespace treacle::identify
