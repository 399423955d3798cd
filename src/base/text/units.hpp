#pragma once
#include <array>
#include <string>
#include <string_view>
#include <variant>

namespace treacle {

// Powers of kilogram, metre, second, kelvin and radian. Angles are a dimension of their own, so that
// "30 deg" is not taken for a length ratio and "5" per second not for an angular velocity.
using Dimension = std::array<int, 5>;

// Unit of an option: that of its plain numbers, always SI, and what else may be written.
struct Unit {
    std::string_view name; // "density"
    std::string_view si;   // "kg/m3"; empty for a plain number
    Dimension dimension{};
    std::string_view accepted; // some spellings, for messages and the manual
    // A second quantity, accepted only when written with its unit; its SI value is multiplied by `factor`.
    Dimension other{};
    double factor = 0; // 0: no second quantity
};

namespace unit {
inline constexpr Unit none{"plain number", "", {}, "%"};
inline constexpr Unit length{"length", "m", {0, 1}, "m, cm, mm, um, km"};
inline constexpr Unit area{"area", "m2", {0, 2}, "m2, cm2, mm2"};
inline constexpr Unit volume{"volume", "m3", {0, 3}, "m3, l, ml, cm3, mm3"};
inline constexpr Unit time{"time", "s", {0, 0, 1}, "s, ms, us, min, h"};
inline constexpr Unit frequency{"frequency", "1/s", {0, 0, -1}, "1/s, Hz, kHz"};
inline constexpr Unit mass{"mass", "kg", {1}, "kg, g, mg"};
inline constexpr Unit density{"density", "kg/m3", {1, -3}, "kg/m3, g/cm3, g/ml, kg/l"};
inline constexpr Unit velocity{"velocity", "m/s", {0, 1, -1}, "m/s, cm/s, mm/s, km/h"};
inline constexpr Unit acceleration{"acceleration", "m/s2", {0, 1, -2}, "m/s2, cm/s2"};
inline constexpr Unit force{"force", "N", {1, 1, -2}, "N, mN, kN"};
inline constexpr Unit pressure{"pressure", "Pa", {1, -1, -2}, "Pa, kPa, MPa, bar, mbar"};
inline constexpr Unit viscosity{"dynamic viscosity", "Pa s", {1, -1, -1}, "Pa.s, mPa.s, P, cP"};
inline constexpr Unit kinematic_viscosity{"kinematic viscosity", "m2/s", {0, 2, -1}, "m2/s, mm2/s, St, cSt"};
inline constexpr Unit surface_tension{"surface tension", "N/m", {1, 0, -2}, "N/m, mN/m, dyn/cm"};
inline constexpr Unit volume_flow{"volume flow", "m3/s", {0, 3, -1}, "m3/s, l/s, ml/s, l/min"};
inline constexpr Unit temperature{"temperature", "K", {0, 0, 0, 1}, "K"};
inline constexpr Unit angle{"angle", "rad", {0, 0, 0, 0, 1}, "rad, deg"};
inline constexpr Unit angular_velocity{"angular velocity", "rad/s", {0, 0, -1, 0, 1}, "rad/s, deg/s, rpm"};

// A dynamic viscosity that may also be written as a kinematic one, which is multiplied by `density` [kg/m3].
Unit viscosity_of(double density);
} // namespace unit

// Why a text is not a value of the unit required: the pieces of a Diagnostic.
struct Complaint {
    std::string must;   // "must be a length [m]"
    std::string reason; // "Pa.s is a dynamic viscosity"
    std::string cure;   // "write one of m, cm, mm"
};

// A number in SI, or a number with a unit ("10 Pa.s", "850 cP", "1 g/cm^3"), in SI. A value read through a
// power of ten is correctly rounded: "5 mm" is the same double as 0.005. Not a number, another dimension, an
// unknown unit and values that are not finite are errors.
std::variant<double, Complaint> read_quantity(std::string_view text, const Unit& unit);

// "3" as "3 Pa s"; a text that carries a unit stays as it is.
std::string with_unit(std::string_view text, const Unit& unit);

} // namespace treacle
