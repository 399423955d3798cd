#pragma once
#include <optional>
#include <string>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::study {

// Division of a range: equal steps of the value, or of its logarithm.
enum class Scale { linear, log };

// A number as a study file writes it: "12 Pa.s" is 12 with the unit "Pa.s". Units are checked by the scene's
// own reader alone.
struct Quantity {
    double value = 0; // in `unit`
    std::string unit;
};
std::optional<Quantity> read_number_and_unit(const std::string& text);

// A value of the scenes that a study varies.
struct Parameter {
    std::string name;
    std::string key;                 // of the scenes, "liquids.syrup.viscosity"
    std::vector<std::string> range;  // lower and upper end, or empty
    std::vector<std::string> values; // those that a grid takes, numbers or words
    std::string start;               // of a search
    Scale scale = Scale::linear;
    int points = 0; // of the range that a grid takes
    std::string where;

    // From the range, or without one from the values; in `unit`.
    bool numeric = false;
    double lower = 0, upper = 0;
    std::string unit;

    void declare(Declaration& d); // item of `parameters`; settles its numbers
    // Finds the numbers and the unit in what was given. The first has the unit; others of its dimension are rewritten in it.
    void settle();

    bool has_range() const { return numeric && range.size() == 2; } // else words, or numbers of a grid
    // As it stands in a scene: "12 Pa.s". The shortest text that reads back as the same double.
    std::string word(double value) const;
    // The number of such a word; nothing for words that are none.
    std::optional<double> number(const std::string& word) const;
    // The value at a fraction in [0, 1] of the way from the lower to the upper end, on the parameter's scale, to 12 digits.
    double at(double fraction) const;
    // "viscosity [Pa.s]"
    std::string column() const;

private:
    void check(Declaration& d) const;
};

// A length, density, ... that was measured: it stands in the scenes with its value, and its uncertainty is known.
struct Measured {
    std::string name, key;
    std::string value;      // "1.42 g/cm3"
    std::string plus_minus; // standard deviation, in the same unit
    double exponent = 0;    // of the value in what is searched, by a textbook formula; 0: not known
    std::string where;

    void declare(Declaration& d); // item of `measured`
};

} // namespace treacle::study
