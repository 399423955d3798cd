#include "identify/material/first_guess.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace treacle::identify {
namespace {

// Each formula as it stands in its source, with a viscosity of 7 Pa s; the guess turns it round. 1e-12: round-off.
constexpr double density = 1300, viscosity = 7, nu = viscosity / density, time = 2.5;

TEST(FirstGuess, SpreadingGivesBackTheViscosityOfItsFront) {
    const double area = 4e-3, volume = 3e-4, angle = 0.3;
    const double plane = 1.411 * std::pow(9.81 * std::pow(area, 3) * time / (3 * nu), 0.2);
    EXPECT_NEAR(plane_spreading(density, area, plane, time), viscosity, 1e-12);
    EXPECT_NEAR(plane_front(nu, area, time), plane, 1e-15);
    const double round = 0.894 * std::pow(9.81 * std::pow(volume, 3) * time / (3 * nu), 0.125);
    EXPECT_NEAR(round_spreading(density, volume, round, time), viscosity, 1e-12);
    EXPECT_NEAR(round_front(nu, volume, time), round, 1e-15);
    const double down = std::cbrt(9 * area * area * 9.81 * std::sin(angle) * time / (4 * nu));
    EXPECT_NEAR(spreading_down(density, area, angle, down, time), viscosity, 1e-12);
    EXPECT_NEAR(film_on_incline(density, angle, 5e-3, 9.81 * std::sin(angle) * 25e-6 / (2 * nu)), viscosity, 1e-12);
}

TEST(FirstGuess, ALongPipeIsPoiseuillesAndAThinHoleHalfOfSampsons) {
    const double a = 2e-3, head = 0.1, pressure = density * 9.81 * head;
    const double pipe = std::numbers::pi * std::pow(a, 4) * pressure / (8 * viscosity * 10.0);
    EXPECT_NEAR(outflow({density, a, 10, head, pipe}) / viscosity, 1, 2e-4); // the entrance: 1.5 pi a / (8 length)
    const double hole = pressure * std::pow(a, 3) / (1.5 * viscosity);
    EXPECT_NEAR(outflow({density, a, 0, head, hole}), viscosity, 1e-12);
}

TEST(FirstGuess, ABallInAWideTubeIsStokesAndNearItsWallSlower) {
    const double speed = 2.0 / 9 * 1500 * 9.81 * 1e-4 / viscosity;
    EXPECT_NEAR(falling_ball(1500, 0.01, 1e6, speed) / viscosity, 1, 1e-7);
    // Haberman & Sayre 1958: drag 1.680 times Stokes' at a radius of 0.2 of the tube's.
    EXPECT_NEAR(viscosity / falling_ball(1500, 0.01, 0.05, speed), 1.680, 2e-3);
}

TEST(FirstGuess, CupsHaveTheirStandardsFormulas) {
    EXPECT_NEAR(*efflux_viscosity("ford4", 50), 3.85e-6 * 45.51, 1e-18);
    EXPECT_NEAR(*efflux_viscosity("zahn2", 34), 70e-6, 1e-18);
    EXPECT_FALSE(efflux_viscosity("zahn2", 14));
    EXPECT_FALSE(efflux_viscosity("ford7", 50));
}

} // namespace
} // namespace treacle::identify
