#pragma once
#include <span>
#include <string>
#include <string_view>

namespace treacle::scene {

// A liquid with its properties at one temperature. Those of food and cosmetics scatter by tens of per cent
// and more between products: the source states it, and a measurement of the user's own is better.
struct Material {
    std::string_view name;
    double density = 0;         // [kg/m3]
    double viscosity = 0;       // [Pa s]
    double surface_tension = 0; // [N/m], against air
    double temperature = 0;     // [K]
    std::string_view source;
};

// All presets, in the order of the table.
std::span<const Material> materials();

// Null when there is no such preset.
const Material* find_material(std::string_view name);

// The table of `treacle materials`.
std::string materials_table();

} // namespace treacle::scene
