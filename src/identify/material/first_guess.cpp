#include "identify/material/first_guess.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace treacle::identify {

namespace {
constexpr double plane_prefactor = 1.411, round_prefactor = 0.894;

double drive(double kinematic_viscosity, double size, double time) {
    return gravity * std::pow(size, 3) * time / (3 * kinematic_viscosity);
}
} // namespace

double plane_spreading(double density, double area, double front, double time) {
    return density * drive(1, area, time) * std::pow(plane_prefactor / front, 5);
}
double plane_front(double kinematic_viscosity, double area, double time) {
    return plane_prefactor * std::pow(drive(kinematic_viscosity, area, time), 0.2);
}

double round_spreading(double density, double volume, double front, double time) {
    return density * drive(1, volume, time) * std::pow(round_prefactor / front, 8);
}
double round_front(double kinematic_viscosity, double volume, double time) {
    return round_prefactor * std::pow(drive(kinematic_viscosity, volume, time), 0.125);
}

double spreading_down(double density, double area, double angle, double front, double time) {
    return density * 9 * area * area * gravity * std::sin(angle) * time / (4 * std::pow(front, 3));
}

double film_on_incline(double density, double angle, double thickness, double speed) {
    return density * gravity * std::sin(angle) * thickness * thickness / (2 * speed);
}

double outflow(const Outflow& hole) {
    const double resistance = 8 * hole.length / (std::numbers::pi * hole.radius) + 1.5;
    return hole.density * gravity * hole.head * std::pow(hole.radius, 3) / (hole.flow * resistance);
}

double falling_ball(double density_difference, double radius, double tube_radius, double speed) {
    const double l = radius / tube_radius;
    const double correction = 1 - 2.104 * l + 2.09 * std::pow(l, 3) - 0.95 * std::pow(l, 5);
    return 2.0 / 9 * density_difference * gravity * radius * radius * correction / speed;
}

std::optional<double> efflux_viscosity(std::string_view cup, double time) {
    struct Cup {
        std::string_view name;
        double factor, offset; // [mm2/s2], [s]
    };
    constexpr std::array cups{Cup{"ford2", 1.44, 18}, Cup{"ford3", 2.31, 6.58}, Cup{"ford4", 3.85, 4.49},
        Cup{"ford5", 12.1, 2}, Cup{"zahn1", 1.1, 29}, Cup{"zahn2", 3.5, 14}, Cup{"zahn3", 11.7, 7.5},
        Cup{"zahn4", 14.8, 5}, Cup{"zahn5", 23, 0}};
    for (const auto& one : cups) {
        if (one.name == cup && time > one.offset) return 1e-6 * one.factor * (time - one.offset);
    }
    return {};
}

} // namespace treacle::identify
