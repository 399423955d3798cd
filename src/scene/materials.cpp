#include "scene/materials.hpp"

#include "base/text/text.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace treacle::scene {

namespace {

constexpr double celsius(double degrees) { return degrees + 273.15; }

constexpr std::string_view sae =
    "representative; the SAE classes allow 50 % up or down (White, Fluid Mechanics, appendix A)";
constexpr std::string_view pdms = "grade [cSt] times density; typical of makers' data sheets";

constexpr std::array presets{
    Material{"water", 998.2, 1.002e-3, 0.0728, celsius(20), "standard tables, pure water"},
    Material{"glycerine", 1261, 1.41, 0.0634, celsius(20),
        "pure; viscosity by the formula of Cheng, Ind. Eng. Chem. Res. 47 (2008); each % of water "
        "lowers it much"},
    Material{"silicone_oil_10", 935, 9.35e-3, 0.0201, celsius(25), pdms},
    Material{"silicone_oil_100", 966, 0.0966, 0.0209, celsius(25), pdms},
    Material{"silicone_oil_1000", 971, 0.971, 0.0212, celsius(25), pdms},
    Material{"silicone_oil_10000", 974, 9.74, 0.0215, celsius(25), pdms},
    Material{"silicone_oil_60000", 976, 58.56, 0.0215, celsius(25), pdms},
    Material{"silicone_oil_100000", 977, 97.7, 0.0215, celsius(25), pdms},
    Material{"motor_oil_sae10", 870, 0.104, 0.036, celsius(20), sae},
    Material{"motor_oil_sae30", 891, 0.29, 0.035, celsius(20), sae},
    Material{"motor_oil_sae50", 902, 0.86, 0.035, celsius(20), sae},
    Material{"olive_oil", 912, 0.084, 0.032, celsius(20), "typical of food engineering tables"},
    Material{"honey", 1420, 10, 0.055, celsius(22),
        "typical for 17 to 18 % water; a degree changes the viscosity by about 10 %, 1 % of water by a "
        "third"},
    Material{"corn_syrup", 1380, 3, 0.08, celsius(25), "typical of light corn syrup; brands differ by a factor of 2"},
    Material{"golden_syrup", 1438, 60, 0.08, celsius(20),
        "light treacle; typical, products and batches differ by tens of per cent"},
    Material{"black_treacle", 1430, 30, 0.07, celsius(20), "order of magnitude; products differ by a factor of 3"},
    Material{"molasses", 1400, 6, 0.06, celsius(20), "order of magnitude; products differ by a factor of 3"},
    Material{"caramel", 1350, 25, 0.06, celsius(40), "order of magnitude of a caramel sauce"},
    Material{"chocolate", 1270, 3, 0.03, celsius(40),
        "order of magnitude of molten milk chocolate at a high shear rate; its yield stress is left out"},
    Material{
        "shampoo", 1030, 4, 0.03, celsius(25), "order of magnitude at a low shear rate; shear thinning is left out"},
};

std::string row(std::string_view name, const std::array<std::string, 4>& numbers, std::string_view source) {
    std::array<char, 128> start;
    std::snprintf(start.data(), start.size(), "%-20s %8s %10s %8s %5s  ", std::string(name).c_str(), numbers[0].c_str(),
        numbers[1].c_str(), numbers[2].c_str(), numbers[3].c_str());
    return start.data() + std::string(source) + "\n";
}

std::string whole(double value) { return std::to_string(std::lround(value)); }

} // namespace

std::span<const Material> materials() { return presets; }

const Material* find_material(std::string_view name) {
    const auto found = std::ranges::find(presets, name, &Material::name);
    return found == presets.end() ? nullptr : &*found;
}

std::string materials_table() {
    std::string out = row("", {"density", "viscosity", "surface", "at"}, "") +
                      row("name", {"[kg/m3]", "[Pa s]", "[N/m]", "[C]"}, "source");
    for (const auto& m : presets) {
        out += row(m.name,
            {format_number(m.density), format_number(m.viscosity), format_number(m.surface_tension),
                whole(m.temperature - celsius(0))},
            m.source);
    }
    return out;
}

} // namespace treacle::scene
