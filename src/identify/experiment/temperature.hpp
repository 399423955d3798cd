#pragma once
#include <string>

namespace treacle {
class Declaration;
}

namespace treacle::identify {

// Temperature of the liquid during the experiments: what a viscosity holds for.
struct Temperature {
    std::string value;      // "22.5 C"; empty: not stated
    std::string plus_minus; // standard deviation, "0.5 C"
    double per_kelvin = 0;  // relative change of the viscosity, negative where it falls; 0: not known

    // Keys of the block `temperature` of a study file.
    void declare(Declaration& d);
    bool stated() const { return !value.empty(); } // false for a study without the block
    // Standard deviation that it adds to the logarithm of a viscosity at this temperature.
    double deviation() const;
    // "22.5 C +- 0.5 C", or that it is not stated.
    std::string text() const;
};

} // namespace treacle::identify
