#include "identify/material/curve_fit.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <random>

namespace treacle::identify {
namespace {

// Rates from 0.1 to 200 1/s, each 1.3 times the one before.
template <class Law>
ViscositiesByRate measured(const Law& law) {
    ViscositiesByRate out;
    for (double rate = 0.1; rate < 200; rate *= 1.3) {
        out.rates.push_back(rate);
        out.viscosities.push_back(law(rate));
    }
    return out;
}

double herschel_bulkley(double rate) { return 5 / rate + 8 * std::pow(rate, -0.5); }

TEST(CurveFit, AHerschelBulkleyLawGivesBackItsParameters) {
    const auto fit = fit_flow_curve(measured(herschel_bulkley));
    EXPECT_NEAR(fit.consistency, 8, 1e-4);
    EXPECT_NEAR(fit.exponent, 0.5, 1e-5);
    EXPECT_NEAR(fit.yield_stress, 5, 1e-4);
    EXPECT_LT(fit.rms, 1e-6);
    EXPECT_NEAR(fit.at(3), herschel_bulkley(3), 1e-4);
}

TEST(CurveFit, ANewtonianCurveHasNoYieldStressAndAPowerLawNone) {
    const auto newtonian = fit_flow_curve(measured([](double) { return 12.0; }));
    EXPECT_NEAR(newtonian.consistency, 12, 1e-6);
    EXPECT_NEAR(newtonian.exponent, 1, 1e-7);
    EXPECT_NEAR(newtonian.yield_stress, 0, 1e-6);
    const auto thickening = fit_flow_curve(measured([](double rate) { return 3 * std::pow(rate, 0.3); }));
    EXPECT_NEAR(thickening.consistency, 3, 1e-6);
    EXPECT_NEAR(thickening.exponent, 1.3, 1e-6);
    EXPECT_NEAR(thickening.yield_stress, 0, 1e-6);
}

TEST(CurveFit, NoiseMovesTheLawByAsMuchAsItScatters) {
    constexpr double noise = 0.03;
    std::mt19937 random(7);
    std::normal_distribution<double> normal(0, noise);
    const auto fit =
        fit_flow_curve(measured([&](double rate) { return herschel_bulkley(rate) * std::exp(normal(random)); }));
    EXPECT_NEAR(fit.rms, noise, 0.01);
    // Of 29 points the curve itself is known to some noise / sqrt(29 / 3) in the middle, twice that at its ends.
    for (const double rate : {0.1, 1.0, 10.0, 150.0})
        EXPECT_NEAR(std::log(fit.at(rate) / herschel_bulkley(rate)), 0, 2.5 * noise) << rate;
    EXPECT_TRUE(fit.is_close());
}

TEST(CurveFit, PointsOutsideOfTheFlowsRatesDoNotCount) {
    const auto curve = measured([](double rate) { return rate < 5 ? 100 : herschel_bulkley(rate); });
    const auto fit = fit_flow_curve(curve, 10, 100);
    EXPECT_NEAR(fit.yield_stress, 5, 1e-3);
    EXPECT_GT(fit.from, 10 / 1.51);
    EXPECT_LT(fit.to, 151);
    EXPECT_EQ(fit.points, 11u);
    // No point is near to these: all are taken, and a law with a step fits none.
    const auto far = fit_flow_curve(curve, 1e4, 2e4);
    EXPECT_EQ(far.points, curve.rates.size());
    EXPECT_FALSE(far.is_close());
}

TEST(CurveFit, ACurveWithAPlateauIsNoHerschelBulkleyLaw) {
    const auto carreau = [](double rate) { return 0.1 + 1000 * std::pow(1 + 4 * rate * rate, -0.45); };
    EXPECT_FALSE(fit_flow_curve(measured(carreau)).is_close());
    EXPECT_TRUE(fit_flow_curve(measured(carreau), 5, 20).is_close());
}

TEST(CurveFit, PointsCountByTheRatesThatTheyStandFor) {
    auto curve = measured([](double rate) { return 10 * std::pow(rate, -0.3) * (rate < 1 ? 1.2 : 1.0); });
    const auto before = fit_flow_curve(curve);
    ViscositiesByRate denser;
    for (std::size_t i = 0; i < curve.rates.size(); ++i) {
        for (int k = 0; k < (curve.rates[i] < 1 ? 10 : 1); ++k) { // ten near each other for each below 1/s
            denser.rates.push_back(curve.rates[i] * (1 + 1e-6 * k));
            denser.viscosities.push_back(curve.viscosities[i]);
        }
    }
    const auto after = fit_flow_curve(denser);
    EXPECT_NEAR(after.exponent, before.exponent, 1e-3);
    EXPECT_NEAR(after.consistency, before.consistency, 1e-2);
}

TEST(CurveFit, TwoPointsMakeAPowerLaw) {
    const auto fit = fit_flow_curve({{1, 100}, {10, 1}});
    EXPECT_NEAR(fit.consistency, 10, 1e-6);
    EXPECT_NEAR(fit.exponent, 0.5, 1e-7);
    EXPECT_EQ(fit.yield_stress, 0);
}

} // namespace
} // namespace treacle::identify
