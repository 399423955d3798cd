#include "identify/first_guess.hpp"

#include <array>
#include <cmath>
#include <numbers>

namespace treacle::identify {

double plane_spreading(double density, double area, double front, double time) {
    constexpr double prefactor = 1.411;
    return density * gravity * std::pow(area, 3) * time / 3 * std::pow(prefactor / front, 5);
}

double round_spreading(double density, double volume, double front, double time) {
    constexpr double prefactor = 0.894;
    return density * gravity * std::pow(volume, 3) * time / 3 * std::pow(prefactor / front, 8);
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
    constexpr std::array cups{Cup{"ford2", 1.44, 18}, Cup{"ford3", 2.31, 6.58}, Cup{"ford4", 3.85, 4.49}, Cup{"ford5", 12.1, 2},    Cup{"zahn1", 1.1, 29},
                              Cup{"zahn2", 3.5, 14},  Cup{"zahn3", 11.7, 7.5}, Cup{"zahn4", 14.8, 5},    Cup{"zahn5", 23, 0}};
    for (const auto& one : cups) {
        if (one.name == cup && time > one.offset) return 1e-6 * one.factor * (time - one.offset);
    }
    return {};
}

} // namespace treacle::identify
