#include "study/model/parameter.hpp"

#include "base/options/options.hpp"
#include "base/text/text.hpp"
#include "base/text/unit_conversion.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace treacle::study {

namespace {
constexpr const char* unit_cure = "write all of them in units of one dimension, as in [100 mPa.s, 100 Pa.s]";

// To 12 digits: 10 in the place of 10.000000000000002.
double plain_number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.12g", value);
    return read_number(text).value_or(value);
}

bool is_of_number(char c) { return (c >= '0' && c <= '9') || c == '.' || c == '+' || c == '-'; }
} // namespace

std::optional<Quantity> read_number_and_unit(const std::string& text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string::npos) return {};
    auto last = first;
    while (last < text.size()) {
        const bool exponent = (text[last] == 'e' || text[last] == 'E') && last > first && last + 1 < text.size() &&
                              is_of_number(text[last + 1]);
        if (!is_of_number(text[last]) && !exponent) break;
        ++last;
    }
    const auto number = read_number(text.substr(first, last - first));
    if (!number || !std::isfinite(*number)) return {};
    const auto unit = text.find_first_not_of(" \t", last);
    if (unit == std::string::npos) return Quantity{*number, ""};
    return Quantity{*number, text.substr(unit, text.find_last_not_of(" \t") + 1 - unit)};
}

void Parameter::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Name of the column; by default the last part of the key.");
    d.text("key", key, "Where the value stands in the scenes, as for --set: liquids.syrup.viscosity.");
    d.required("key");
    if (d.parsing() && name.empty()) name = key.substr(key.rfind('.') + 1);
    d.check(name.find_first_of(",\"\n\r=") == std::string::npos, "name",
        {"must not have a comma, a quote, '=' or a line break", "it becomes the header of a column",
            "choose a plainer name"});
    d.texts("range", range,
        "Lower and upper end, numbers with the unit that the scene's key may have: [0.1 Pa.s, 100 Pa.s].");
    d.texts(
        "values", values, "Values that a grid takes, in the place of a range: numbers, or words such as sph and grid.");
    d.text("start", start, "Where a search begins; by default the middle of the range.");
    d.choice<Scale>("scale", scale, {{"linear", Scale::linear}, {"log", Scale::log}},
        "How the range is divided and searched: log for what may differ by decades, such as a viscosity.");
    d.integer(
        "points", points, range_at_least(0), "Number of values of the range that a grid takes, both ends included.");
    if (!d.parsing()) return;
    settle();
    check(d);
}

void Parameter::settle() {
    numeric = false;
    for (auto& text : range.empty() ? values : range) {
        auto quantity = read_number_and_unit(text);
        if (!quantity) {
            numeric = false;
            return;
        }
        if (!numeric) unit = quantity->unit;
        if (const auto converted = quantity->unit == unit ? std::nullopt : in_unit(text, unit)) {
            quantity->value = plain_number(*converted);
            text = word(quantity->value);
        }
        lower = numeric ? std::min(lower, quantity->value) : quantity->value;
        upper = numeric ? std::max(upper, quantity->value) : quantity->value;
        numeric = true;
    }
}

void Parameter::check(Declaration& d) const {
    const bool ranged = !range.empty();
    const char* given = ranged ? "range" : "values";
    d.check(!ranged || range.size() == 2, "range",
        {"must be a lower and an upper end", "", "write for instance [0.1 Pa.s, 100 Pa.s]"});
    d.check(!ranged || values.empty(), "values",
        {"must be left out beside a range", "one of them says what values there are", ""});
    d.check(!ranged || numeric, "range", {"must be two numbers", "", "write for instance [0.1 Pa.s, 100 Pa.s]"});
    if (!numeric) return;
    for (const auto& text : ranged ? range : values) {
        const auto other = read_number_and_unit(text)->unit;
        d.check(other == unit, given,
            {"must have units of one dimension", unit + " and " + other + " stand in it", unit_cure});
    }
    if (ranged && range.size() == 2) {
        d.check(read_number_and_unit(range[1])->value > read_number_and_unit(range[0])->value, "range",
            {"must have its lower end first", "it goes from " + range[0] + " to " + range[1], ""});
    }
    d.check(scale == Scale::linear || lower > 0, given,
        {"must be above 0", "the scale is log", "raise the lower end, or take scale: linear"});
    if (start.empty()) return;
    const auto begin = number(start);
    d.check(begin.has_value(), "start",
        {"must be a number in " + (unit.empty() ? std::string("no unit") : unit), "", unit_cure});
    if (!begin || !ranged) return;
    d.check(*begin >= lower && *begin <= upper, "start",
        {"must lie in the range", "the range goes from " + range.front() + " to " + range.back(),
            "widen the range, or start in it"});
}

std::string Parameter::word(double value) const { return format_number(value) + (unit.empty() ? "" : " " + unit); }

std::optional<double> Parameter::number(const std::string& word) const {
    const auto quantity = read_number_and_unit(word);
    if (!quantity || quantity->unit != unit) return {};
    return quantity->value;
}

double Parameter::at(double fraction) const {
    if (fraction <= 0) return lower;
    if (fraction >= 1) return upper;
    return plain_number(scale == Scale::linear ? lower + fraction * (upper - lower)
                                               : lower * std::exp(fraction * std::log(upper / lower)));
}

std::string Parameter::column() const { return name + (unit.empty() ? "" : " [" + unit + "]"); }

void Measured::declare(Declaration& d) {
    if (d.parsing()) where = d.location();
    d.text("name", name, "Name in reports; by default the last part of the key.");
    d.text("key", key, "Where the value stands in the scenes: liquids.syrup.density.");
    d.required("key");
    if (d.parsing() && name.empty()) name = key.substr(key.rfind('.') + 1);
    d.text("value", value, "What was measured, with its unit: 1.42 g/cm3.");
    d.required("value");
    d.text("plus_minus", plus_minus, "Standard deviation, in the same unit.");
    d.required("plus_minus");
    d.number("exponent", exponent, unit::none, range_any(),
        "Power of the value in the first parameter, by a textbook formula: 3 for the length of a block that spreads. "
        "`treacle check` tells the "
        "value's share of the interval by it until runs have told it; 0: not known.");
    if (!d.parsing()) return;
    const auto number = read_number_and_unit(value), deviation = read_number_and_unit(plus_minus);
    d.check(number.has_value(), "value", {"must be a number, with a unit", "", "write for instance 1.42 g/cm3"});
    d.check(deviation && deviation->value >= 0, "plus_minus",
        {"must be a number >= 0, with a unit", "", "write for instance 0.01 g/cm3"});
    if (number && deviation) {
        d.check(number->unit == deviation->unit, "plus_minus",
            {"must have the unit of the value", "that is " + number->unit, ""});
    }
}

} // namespace treacle::study
