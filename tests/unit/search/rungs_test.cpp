#include "search/rungs.hpp"

#include "base/text/error.hpp"
#include "search/problem/random.hpp"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

namespace treacle::search {
namespace {

std::vector<Rung> series(double value, double slope, double order, std::vector<double> spacings) {
    std::vector<Rung> out;
    for (const double h : spacings) out.push_back({h, value + slope * std::pow(h, order)});
    return out;
}

// Beyond the finest rung lies the extrapolation by the order, and the order stays uncertain.
TEST(Rungs, APowerIsFollowedToSpacingZero) {
    for (const double order : {0.75, 1.0, 1.25, 1.5})
        for (const auto& spacings :
            {std::vector<double>{0.25, 0.5, 1}, {1, 0.25, 0.6}, {0.35, 0.5, 0.7, 1}, {0.4, 0.5, 0.7, 1}}) {
            const auto found = extrapolate(series(2.3, -0.05, order, spacings), {});
            const double exact = 0.05 * std::pow(std::ranges::min(spacings), order);
            EXPECT_NEAR(found.order, order, 0.65); // drawn to the usual one
            EXPECT_GT(found.correction, 0.4 * exact);
            EXPECT_LT(found.correction, 3 * exact);
            EXPECT_LT(std::abs(found.value - 2.3), 2 * found.deviation);
            EXPECT_GT(found.deviation, 0.2 * exact);
            EXPECT_LT(found.deviation, 1.5 * std::max(exact, 0.01));
        }
}

TEST(Rungs, WithoutAnOrderTheDeviationIsAsLargeAsTheirDifferences) {
    const std::vector<std::vector<Rung>> without{{{1, 2.0}, {1.4, 2.1}, {2, 2.05}}, // not monotone
        {{1, 2.0}, {1.4, 2.002}, {2, 2.1}},                                         // order 8
        {{1, 2.0}, {1.4, 2.1}}};
    for (const auto& rungs : without) {
        const auto found = extrapolate(rungs, {0.01, 4});
        EXPECT_GT(found.deviation, 0.04);
        EXPECT_LT(std::abs(found.correction), 0.25);
    }
}

// The scatter of answers at one spacing stays in the deviation, less at finer spacings, and rungs that are near to each other
// are not followed by their noise.
TEST(Rungs, NoiseIsNotTakenForAnOrder) {
    const auto still = extrapolate(series(2.3, 0, 1, {1, 2, 4}), {0.02, 4});
    EXPECT_EQ(still.correction, 0);
    EXPECT_GT(still.deviation, 0.02 / 8);
    EXPECT_GT(still.noise, 0.5 * 0.02 / 8);
    EXPECT_LE(still.noise, still.deviation);
    const std::vector<Rung> near{{4.5, 2.32}, {5.5, 2.30}, {7, 2.33}};
    const auto found = extrapolate(near, {0.02, 4});
    EXPECT_LT(std::abs(found.correction), 0.02);
    EXPECT_GT(found.deviation, 0.015);
}

// First order with a second-order part and noise that is known by four degrees of freedom: intervals have their nominal
// coverage, and the deviation is no more than three times the error that there is.
TEST(Rungs, TheDeviationIsHonest) {
    const Random random(3);
    int ninety = 0, fifty = 0;
    double squares = 0, deviations = 0;
    constexpr int cases = 400;
    for (std::uint32_t k = 0; k < cases; ++k) {
        const auto normal = [&](std::uint32_t i, std::uint32_t j) { return random.normal(Purpose::model, i, k, j); };
        const double first = 0.05 * normal(0, 0), second = 0.02 * normal(0, 1), noise = 0.01;
        double measured = 0;
        for (std::uint32_t i = 0; i < 4; ++i) measured += 0.25 * std::pow(noise * normal(2, i), 2);
        std::vector<Rung> rungs;
        for (const double h : {0.5, 0.7, 1.0})
            rungs.push_back(
                {h, 1 + first * h + second * h * h + noise * std::pow(h, 1.5) * normal(1, std::uint32_t(10 * h))});
        const auto found = extrapolate(rungs, {std::sqrt(measured), 4});
        ninety += std::abs(found.value - 1) < 1.645 * found.deviation;
        fifty += std::abs(found.value - 1) < 0.6745 * found.deviation;
        squares += std::pow(found.value - 1, 2) / cases;
        deviations += std::pow(found.deviation, 2) / cases;
    }
    EXPECT_GE(ninety, 0.88 * cases); // measured 90 %
    EXPECT_GE(fifty, 0.5 * cases);   // measured 57 %
    EXPECT_LE(ninety, 0.99 * cases);
    EXPECT_LT(std::sqrt(deviations), 3 * std::sqrt(squares));
}

TEST(Rungs, RefusesWhatShowsNothing) {
    EXPECT_THROW(extrapolate(series(1, 1, 1, {1}), {}), InputError);
    EXPECT_THROW(extrapolate(series(1, 1, 1, {1, 1, 2}), {}), InputError);
    EXPECT_THROW(extrapolate(series(1, 1, 1, {0, 1, 2}), {}), InputError);
}

} // namespace
} // namespace treacle::search
