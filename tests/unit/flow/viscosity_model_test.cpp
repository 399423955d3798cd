#include "flow/viscosity_model.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace treacle::flow {
namespace {
ViscosityModel curve(scene::ViscosityModelKind law) {
    scene::Liquid liquid;
    liquid.viscosity = 5;
    liquid.rheology.law = law;
    liquid.rheology.exponent = 0.5;
    return make_viscosity_model(liquid);
}
constexpr double roundings = 1e-14;
} // namespace

TEST(ViscosityModel, ANewtonianLiquidHasOneViscosity) {
    EXPECT_EQ(curve(scene::ViscosityModelKind::newtonian)(0), 5);
    EXPECT_EQ(curve(scene::ViscosityModelKind::newtonian)(1e5), 5);
}

TEST(ViscosityModel, APowerLawThinsAndEndsAtTheLeastRate) {
    const auto mu = curve(scene::ViscosityModelKind::power_law);
    EXPECT_NEAR(mu(100), 5 / std::sqrt(100), 1e-9) << "1e-3 beside 100, squared";
    EXPECT_NEAR(mu(0), 5 / std::sqrt(1e-3), roundings * 200);
    EXPECT_LT(mu(1e-3), mu(0));
}

TEST(ViscosityModel, CarreauAndCrossFallFromOnePlateauToTheOther) {
    for (const auto law : {scene::ViscosityModelKind::carreau, scene::ViscosityModelKind::cross}) {
        auto mu = curve(law);
        mu.infinite_shear_viscosity = 1;
        mu.relaxation_time = 2;
        EXPECT_EQ(mu(0), 5);
        EXPECT_NEAR(mu(1e14), 1, 1e-6);
        EXPECT_GT(mu(0.1), mu(1));
    }
    auto carreau = curve(scene::ViscosityModelKind::carreau);
    carreau.relaxation_time = 2;
    EXPECT_NEAR(carreau(1), 5 * std::pow(5, -0.25), roundings * 5);
    auto cross = curve(scene::ViscosityModelKind::cross);
    cross.relaxation_time = 4;
    EXPECT_NEAR(cross(1), 5.0 / 3, roundings * 5);
}

TEST(ViscosityModel, AYieldStressIsReachedBeyondTheRegularisation) {
    auto mu = curve(scene::ViscosityModelKind::herschel_bulkley);
    mu.exponent = 1;
    mu.yield_stress = 10;
    mu.regularisation = 100;
    EXPECT_NEAR(mu(0), 5 + 1000, 1e-9);
    EXPECT_NEAR(mu(1e-9), mu(0), 1e-4) << "no step where the series takes over";
    EXPECT_NEAR(mu(1.01e-8), mu(0.99e-8), 1.1e-5) << "the slope is 5e4";
    EXPECT_NEAR(2 * mu(2), 10 + 5 * 2, 1e-9) << "the stress of a Bingham fluid";
}

TEST(ViscosityProfile, GoesThroughItsPointsAndStaysBeyondThem) {
    scene::ViscosityProfile profile;
    profile.points = {{1, 10}, {3, 1000}, {4, 0}};
    EXPECT_EQ(profile.at(-5), 10);
    EXPECT_EQ(profile.at(1), 10);
    EXPECT_NEAR(profile.at(2), 505, 1e-10);
    EXPECT_NEAR(profile.at(3.25), 750, 1e-10);
    EXPECT_EQ(profile.at(9), 0);
    profile.points.pop_back();
    profile.interpolation = scene::Interpolation::logarithmic;
    EXPECT_NEAR(profile.at(2), 100, 1e-10);
}

} // namespace treacle::flow
