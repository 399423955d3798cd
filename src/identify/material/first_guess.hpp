#pragma once
#include <optional>
#include <string_view>

namespace treacle::identify {

// Viscosities [Pa s] by textbook formulas, to begin a search with: mostly right to a factor of two, for creeping flow without
// surface tension. All arguments are positive and in SI; `gravity` is 9.81 m/s2.
inline constexpr double gravity = 9.81;

// A volume of `area` per width [m2] behind which there is a wall spreads over a level floor to `front` [m] from the wall in
// `time`: front = 1.411 (g area^3 t / (3 nu))^(1/5). Huppert 1982, J. Fluid Mech. 121, equation 2.20.
double plane_spreading(double density, double area, double front, double time);

// The front that this is for a kinematic viscosity [m2/s].
double plane_front(double kinematic_viscosity, double area, double time);

// A volume [m3] spreads to a disc of radius `front`: front = 0.894 (g V^3 t / (3 nu))^(1/8). Huppert 1982, equation 2.21.
double round_spreading(double density, double volume, double front, double time);

// Front [m] of the same spreading for a kinematic viscosity [m2/s].
double round_front(double kinematic_viscosity, double volume, double time);

// A volume of `area` per width flows down a slope of `angle` [rad]: front = (9 area^2 g sin(angle) t / (4 nu))^(1/3), from where
// it began. Huppert 1982, Nature 300, 427.
double spreading_down(double density, double area, double angle, double front, double time);

// A film of even thickness flows down a slope: speed of its surface = g sin(angle) thickness^2 / (2 nu). Nusselt 1916.
double film_on_incline(double density, double angle, double thickness, double speed);

// Flow [m3/s] out of a round hole into the open under a head of liquid [m], that above the hole's lower end:
// density g head = viscosity flow / radius^3 (8 length / (pi radius) + 3 / 2): Hagen and Poiseuille, and Sampson's loss (1891) at
// the entrance alone.
struct Outflow {
    double density = 0, radius = 0, length = 0, head = 0, flow = 0; // [kg/m3], [m], [m], [m], [m3/s]
};
double outflow(const Outflow& hole);

// A ball falls along the axis of a tube at `speed`: Stokes 1851, 2/9 (difference of densities) g radius^2 / speed, times Faxen's
// correction 1 - 2.104 l + 2.09 l^3 - 0.95 l^5 with l = radius / tube radius (1922), good below l = 0.3.
double falling_ball(double density_difference, double radius, double tube_radius, double speed);

// Kinematic viscosity [m2/s] by the time that a standard cup takes to empty: factor (time - offset), "ford2" to "ford5" (ASTM
// D1200) and "zahn1" to "zahn5" (ASTM D4212). Nothing for an unknown cup, or a time below its offset.
std::optional<double> efflux_viscosity(std::string_view cup, double time);

} // namespace treacle::identify
