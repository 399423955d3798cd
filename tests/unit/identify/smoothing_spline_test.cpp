#include "identify/compare/smoothing_spline.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>

namespace treacle::identify {
namespace {

std::vector<double> times_of(int count) {
    std::vector<double> out;
    for (int i = 0; i < count; ++i) out.push_back(0.02 * i + (i % 3 == 1 ? 0.004 : 0));
    return out;
}

TEST(SmoothingSpline, WithoutDeviationsItPassesThroughTheValues) {
    const auto times = times_of(30);
    std::vector<double> values;
    for (const double t : times) values.push_back(std::sin(5 * t));
    const SmoothingSpline spline(times, values, std::vector<double>(times.size(), 0));
    for (std::size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(spline.at(times[i]), values[i], 1e-12);
    // Between them h^4 / 384 of the fourth derivative, 625, inside, and its slope h^3 / 24 of it.
    EXPECT_NEAR(spline.at(0.31), std::sin(1.55), 2e-6);
    EXPECT_NEAR(spline.slope(0.31), 5 * std::cos(1.55), 1e-3);
}

TEST(SmoothingSpline, AStraightPathStaysStraightBeyondItsEnds) {
    const auto times = times_of(12);
    std::vector<double> values;
    for (const double t : times) values.push_back(2 - 3 * t);
    const SmoothingSpline spline(times, values, std::vector<double>(times.size(), 0.1));
    for (const double t : {-0.2, 0.03, 0.17, 0.5}) {
        EXPECT_NEAR(spline.at(t), 2 - 3 * t, 1e-9);
        EXPECT_NEAR(spline.slope(t), -3, 1e-8);
    }
}

TEST(SmoothingSpline, NoiseOfPickedPlacesDoesNotReachTheVelocities) {
    // Finite differences of these places would err by 5e-5 sqrt 2 / 0.02 = 3.5e-3, a tenth of the velocity.
    std::mt19937 generator{3};
    std::normal_distribution<double> normal(0, 5e-5);
    const auto times = times_of(50);
    std::vector<double> values;
    for (const double t : times) values.push_back(-0.035 * t + 0.004 * std::exp(-t / 0.05) + normal(generator));
    const SmoothingSpline spline(times, values, std::vector<double>(times.size(), 5e-5));
    double squares = 0, left = 0;
    for (std::size_t i = 5; i + 5 < times.size(); ++i)
        squares += std::pow(spline.slope(times[i]) + 0.035 + 0.08 * std::exp(-times[i] / 0.05), 2) / 40;
    for (std::size_t i = 0; i < times.size(); ++i) left += std::pow((values[i] - spline.at(times[i])) / 5e-5, 2);
    EXPECT_LT(std::sqrt(squares), 1.5e-3);
    EXPECT_NEAR(left, 50, 0.1); // Reinsch's choice
}

TEST(SmoothingSpline, RefusesTimesThatDoNotGrow) {
    const std::vector<double> values{1, 2, 3}, none{0, 0, 0};
    EXPECT_THROW(SmoothingSpline(std::vector<double>{0, 1, 1}, values, none), std::invalid_argument);
    EXPECT_THROW(
        SmoothingSpline(std::vector<double>{0}, std::vector<double>{1}, std::vector<double>{0}), std::invalid_argument);
}

} // namespace
} // namespace treacle::identify
