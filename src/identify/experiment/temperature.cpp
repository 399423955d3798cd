#include "identify/experiment/temperature.hpp"

#include "base/options/options.hpp"
#include "study/model/parameter.hpp"

#include <cmath>

namespace treacle::identify {

namespace {
bool is_temperature(const std::string& text) {
    const auto read = study::read_number_and_unit(text);
    return read && (read->unit == "C" || read->unit == "K");
}
} // namespace

void Temperature::declare(Declaration& d) {
    d.text("value", value, "What a thermometer in the liquid showed, in C or K: 22.5 C.");
    d.text("plus_minus", plus_minus, "Standard deviation, in C or K, with how uneven it was.");
    d.number("per_kelvin", per_kelvin, unit::none, range_between(-1, 1),
        "Relative change of the viscosity by a kelvin: -8 % for honey. With it the uncertainty of the temperature "
        "enters the interval of a viscosity.");
    d.check(value.empty() || is_temperature(value), "value",
        {"must be a number with the unit C or K", "", "write for instance 22.5 C"});
    d.check(plus_minus.empty() || is_temperature(plus_minus), "plus_minus",
        {"must be a number with the unit C or K", "", "write for instance 0.5 C"});
    d.check(value.empty() == plus_minus.empty(), "value",
        {"must be given with plus_minus", "each says nothing without the other",
            "write for instance value: 22.5 C, plus_minus: 0.5 C"});
    d.check(stated() || per_kelvin == 0, "per_kelvin",
        {"has no effect", "no temperature is stated", "give value and plus_minus"});
}

double Temperature::deviation() const {
    const auto read = study::read_number_and_unit(plus_minus);
    return read ? std::abs(per_kelvin * read->value) : 0;
}

std::string Temperature::text() const {
    return stated() ? value + " +- " + plus_minus : "not stated: a viscosity changes by 1 to 10 % a kelvin";
}

} // namespace treacle::identify
