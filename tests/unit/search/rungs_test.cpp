#include "search/rungs.hpp"

#include "base/error.hpp"
#include "search/random.hpp"

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

TEST(Rungs, AnExactOrderIsFoundWhateverTheRatios) {
    for (const double order : {0.7, 1.0, 1.5, 2.0})
        for (const auto& spacings : {std::vector<double>{1, 2, 4}, {1, 1.4, 2}, {4, 1, 2.7}, {1, 1.3, 1.9, 3}}) {
            const auto found = extrapolate(series(2.3, -0.1, order, spacings), 0);
            EXPECT_NEAR(found.order, order, 1e-5);
            EXPECT_NEAR(found.value, 2.3, 1e-6);
            EXPECT_NEAR(found.correction, 0.1, 1e-6); // the finest spacing is 1
            EXPECT_NEAR(found.deviation, 0.5 * 1.25 * 0.1, 1e-6);
        }
}

TEST(Rungs, WithoutAnOrderTheLargestDifferenceIsTheDeviation) {
    const std::vector<std::vector<Rung>> without{{{1, 2.0}, {2, 2.1}, {4, 2.05}},  // not monotone
                                                 {{1, 2.0}, {2, 2.1}, {4, 2.102}}, // far from the range where one order rules
                                                 {{1, 2.0}, {2, 2.002}, {4, 2.1}}, // order 5.6
                                                 {{1, 2.0}, {2, 2.1}}};
    for (const auto& rungs : without) {
        const auto found = extrapolate(rungs, 0);
        EXPECT_EQ(found.value, 2.0);
        EXPECT_EQ(found.correction, 0);
        EXPECT_EQ(found.order, 0);
        EXPECT_GE(found.deviation, 0.1 - 1e-12);
        EXPECT_NE(found.text.find("largest difference"), std::string::npos);
    }
}

TEST(Rungs, NoiseIsTheFloorAndNoOrder) {
    const auto found = extrapolate(series(2.3, 0.001, 1, {1, 2, 4}), 0.01);
    EXPECT_EQ(found.correction, 0);
    EXPECT_EQ(found.deviation, 0.01);
    const auto steep = extrapolate(series(2.3, 0.1, 1, {1, 2, 4}), 0.01);
    EXPECT_NEAR(steep.correction, -0.1, 1e-6);
    EXPECT_GT(steep.deviation, std::hypot(0.0625, 0.01)); // noise of the extrapolated value is above that of a rung
}

// First order with a second-order part and noise: the truth is within two deviations in 95 % of 400 cases or more, and
// the deviation is no more than three times the error that there is.
TEST(Rungs, TheDeviationIsHonest) {
    const Random random(3);
    int inside = 0;
    double squares = 0, deviations = 0;
    constexpr int cases = 400;
    for (std::uint32_t k = 0; k < cases; ++k) {
        const double first = 0.05 * random.normal(Purpose::model, 0, k, 0);
        const double second = 0.02 * random.normal(Purpose::model, 0, k, 1);
        std::vector<Rung> rungs;
        for (const double h : {1.0, 1.4, 2.0, 2.8})
            rungs.push_back({h, 1 + first * h + second * h * h +
                                    0.003 * random.normal(Purpose::model, 1, k, static_cast<std::uint32_t>(10 * h))});
        const auto found = extrapolate(rungs, 0.003);
        inside += std::abs(found.value - 1) < 2 * found.deviation;
        squares += std::pow(found.value - 1, 2) / cases;
        deviations += std::pow(found.deviation, 2) / cases;
    }
    EXPECT_GE(inside, 384); // measured 98 %
    EXPECT_LT(std::sqrt(deviations), 3 * std::sqrt(squares));
}

TEST(Rungs, RefusesWhatShowsNothing) {
    EXPECT_THROW(extrapolate(series(1, 1, 1, {1}), 0), InputError);
    EXPECT_THROW(extrapolate(series(1, 1, 1, {1, 1, 2}), 0), InputError);
    EXPECT_THROW(extrapolate(series(1, 1, 1, {0, 1, 2}), 0), InputError);
}

} // namespace
} // namespace treacle::search
