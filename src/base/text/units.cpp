#include "base/text/units.hpp"

#include "base/text/text.hpp"
#include "base/text/unit_conversion.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace treacle {

Unit unit::viscosity_of(double density) {
    Unit out = viscosity;
    out.accepted = "Pa.s, mPa.s, P, cP, or as a kinematic viscosity m2/s, mm2/s, St, cSt";
    out.other = kinematic_viscosity.dimension;
    out.factor = density;
    return out;
}

namespace {

// A unit as multiplier times a power of ten: decimal factors stay exact.
struct Scale {
    double multiplier = 1;
    int exponent = 0;
    Dimension dimension{};
};

enum class Prefixes { none, all };

struct Symbol {
    std::string_view name;
    Scale scale;
    Prefixes prefixes;
};

constexpr double pi = std::numbers::pi;
constexpr std::array symbols{
    Symbol{"m", {1, 0, {0, 1}}, Prefixes::all},
    Symbol{"g", {1, -3, {1}}, Prefixes::all},
    Symbol{"t", {1, 3, {1}}, Prefixes::none},
    Symbol{"s", {1, 0, {0, 0, 1}}, Prefixes::all},
    Symbol{"min", {60, 0, {0, 0, 1}}, Prefixes::none},
    Symbol{"h", {3600, 0, {0, 0, 1}}, Prefixes::none},
    Symbol{"K", {1, 0, {0, 0, 0, 1}}, Prefixes::all},
    Symbol{"rad", {1, 0, {0, 0, 0, 0, 1}}, Prefixes::all},
    Symbol{"deg", {pi / 180, 0, {0, 0, 0, 0, 1}}, Prefixes::none},
    Symbol{"°", {pi / 180, 0, {0, 0, 0, 0, 1}}, Prefixes::none},
    Symbol{"rpm", {2 * pi / 60, 0, {0, 0, -1, 0, 1}}, Prefixes::none},
    Symbol{"Hz", {1, 0, {0, 0, -1}}, Prefixes::all},
    Symbol{"N", {1, 0, {1, 1, -2}}, Prefixes::all},
    Symbol{"dyn", {1, -5, {1, 1, -2}}, Prefixes::none},
    Symbol{"Pa", {1, 0, {1, -1, -2}}, Prefixes::all},
    Symbol{"bar", {1, 5, {1, -1, -2}}, Prefixes::all},
    Symbol{"J", {1, 0, {1, 2, -2}}, Prefixes::all},
    Symbol{"W", {1, 0, {1, 2, -3}}, Prefixes::all},
    Symbol{"P", {1, -1, {1, -1, -1}}, Prefixes::all},
    Symbol{"St", {1, -4, {0, 2, -1}}, Prefixes::all},
    Symbol{"l", {1, -3, {0, 3}}, Prefixes::all},
    Symbol{"L", {1, -3, {0, 3}}, Prefixes::all},
    Symbol{"%", {1, -2, {}}, Prefixes::none},
};

struct Prefix {
    std::string_view name;
    int exponent;
};
constexpr std::array prefixes{Prefix{"k", 3}, Prefix{"M", 6}, Prefix{"G", 9}, Prefix{"h", 2}, Prefix{"d", -1},
    Prefix{"c", -2}, Prefix{"m", -3}, Prefix{"u", -6}, Prefix{"µ", -6}, Prefix{"μ", -6}, Prefix{"n", -9}};

constexpr std::array named{unit::none, unit::length, unit::area, unit::volume, unit::time, unit::frequency, unit::mass,
    unit::density, unit::velocity, unit::acceleration, unit::force, unit::pressure, unit::viscosity,
    unit::kinematic_viscosity, unit::surface_tension, unit::volume_flow, unit::temperature, unit::angle,
    unit::angular_velocity};

std::optional<Scale> find_symbol(std::string_view word) {
    for (const auto& symbol : symbols) {
        if (symbol.name == word) return symbol.scale;
    }
    for (const auto& prefix : prefixes) {
        if (!word.starts_with(prefix.name)) continue;
        for (const auto& symbol : symbols) {
            if (symbol.prefixes == Prefixes::none || symbol.name != word.substr(prefix.name.size())) continue;
            Scale scale = symbol.scale;
            scale.exponent += prefix.exponent;
            return scale;
        }
    }
    return {};
}

bool is_letter(char c) {
    const auto u = static_cast<unsigned char>(c);
    return std::isalpha(u) || u >= 0x80 || c == '%';
}

// Reads "kg/m3", "m/s^2", "Pa.s", "Pa s", "1/s", "s^-1". A '/' holds for the next factor only.
class UnitReader {
public:
    explicit UnitReader(std::string_view text) : text_(text) {}

    std::optional<Scale> read() {
        Scale out;
        int sign = 1;
        if (take("1/") || take("1 /")) sign = -1;
        do {
            skip_blanks();
            const auto factor = read_factor();
            if (!factor) return {};
            const auto& [scale, power] = *factor;
            out.multiplier *= std::pow(scale.multiplier, sign * power);
            out.exponent += sign * power * scale.exponent;
            for (std::size_t i = 0; i < out.dimension.size(); ++i) {
                out.dimension[i] += sign * power * scale.dimension[i];
            }
        } while (read_operator(sign));
        if (!text_.empty()) return {};
        return out;
    }

private:
    // Letters by their bytes, but not of a symbol.
    static bool is_mark(std::string_view text) {
        return text.starts_with("·") || text.starts_with("²") || text.starts_with("³");
    }

    std::optional<std::pair<Scale, int>> read_factor() {
        std::size_t n = 0;
        while (n < text_.size() && is_letter(text_[n]) && !is_mark(text_.substr(n))) ++n;
        const auto scale = find_symbol(text_.substr(0, n));
        if (!scale) return {};
        text_.remove_prefix(n);
        const auto power = read_power();
        if (!power) return {};
        return std::pair{*scale, *power};
    }

    // "2", "^2", "^-2", "**2", "²"; without one the power is 1. Nothing when malformed.
    std::optional<int> read_power() {
        if (take("²")) return 2;
        if (take("³")) return 3;
        const bool caret = take("^") || take("**");
        const int sign = caret && take("-") ? -1 : 1;
        const auto digit_next = [&] { return !text_.empty() && std::isdigit(static_cast<unsigned char>(text_[0])); };
        if (!digit_next()) return caret ? std::optional<int>{} : 1;
        const int digit = text_[0] - '0';
        text_.remove_prefix(1);
        return digit_next() ? std::optional<int>{} : sign * digit;
    }

    bool read_operator(int& sign) {
        const bool blank = skip_blanks();
        sign = 1;
        if (take("/")) {
            sign = -1;
            return true;
        }
        return take(".") || take("*") || take("·") || (blank && !text_.empty());
    }

    bool take(std::string_view token) {
        if (!text_.starts_with(token)) return false;
        text_.remove_prefix(token.size());
        return true;
    }

    bool skip_blanks() {
        const auto n = std::min(text_.find_first_not_of(" \t"), text_.size());
        text_.remove_prefix(n);
        return n > 0;
    }

    std::string_view text_;
};

std::string_view trim(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\n\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\n\r") - first + 1);
}

// Length of the number at the start of the text.
std::size_t number_length(std::string_view text) {
    std::size_t n = 0;
    const auto digits = [&] {
        const auto start = n;
        while (n < text.size() && std::isdigit(static_cast<unsigned char>(text[n]))) ++n;
        return n - start;
    };
    if (n < text.size() && (text[n] == '+' || text[n] == '-')) ++n;
    const auto whole = digits();
    std::size_t fraction = 0;
    if (n < text.size() && text[n] == '.') {
        ++n;
        fraction = digits();
    }
    if (whole + fraction == 0) return 0;
    const auto mantissa = n;
    if (n < text.size() && (text[n] == 'e' || text[n] == 'E')) {
        ++n;
        if (n < text.size() && (text[n] == '+' || text[n] == '-')) ++n;
        if (digits() == 0) n = mantissa;
    }
    return n;
}

double apply(const Scale& scale, double value) {
    const double ten = std::pow(10.0, std::abs(scale.exponent));
    return (scale.exponent < 0 ? value / ten : value * ten) * scale.multiplier;
}

std::string expected(const Unit& unit) {
    if (unit.si.empty()) return "must be a plain number";
    const bool vowel = std::string_view("aeiou").find(unit.name[0]) != std::string_view::npos;
    return std::string("must be a") + (vowel ? "n " : " ") + std::string(unit.name) + " [" + std::string(unit.si) + "]";
}

std::string accepted(const Unit& unit) {
    return unit.si.empty() ? "write it without a unit" : "accepted units: " + std::string(unit.accepted);
}

std::string describe(const Dimension& dimension) {
    for (const auto& unit : named) {
        if (unit.dimension == dimension) return "the unit of a " + std::string(unit.name);
    }
    return "the unit of something else";
}

Complaint not_a_number(std::string_view text, const Unit& unit) {
    std::string word;
    for (const char c : text) {
        if (std::isalpha(static_cast<unsigned char>(c))) word += static_cast<char>(std::tolower(c));
    }
    if (word == "inf" || word == "infinity" || word == "nan") {
        return {"must be finite", "a simulation cannot start from it", "write a number"};
    }
    return {expected(unit), "a number comes first, then its unit if it is not SI", accepted(unit)};
}

} // namespace

std::variant<double, Complaint> read_quantity(std::string_view text, const Unit& unit) {
    text = trim(text);
    const auto length = number_length(text);
    const auto number = read_number(text.substr(0, length));
    if (!number) return not_a_number(text, unit);
    const auto rest = trim(text.substr(length));
    Scale scale;
    scale.dimension = unit.dimension;
    if (!rest.empty()) {
        const auto read = UnitReader(rest).read();
        const std::string quoted = "\"" + std::string(rest) + "\"";
        if (!read) return Complaint{expected(unit), quoted + " is not a known unit", accepted(unit)};
        scale = *read;
        if (unit.factor != 0 && scale.dimension == unit.other) {
            scale.multiplier *= unit.factor;
        } else if (scale.dimension != unit.dimension) {
            return Complaint{expected(unit), quoted + " is " + describe(scale.dimension), accepted(unit)};
        }
    }
    const double value = apply(scale, *number);
    if (!std::isfinite(value)) return Complaint{"must be finite", "the number is too large for a double", ""};
    return value;
}

std::optional<double> in_unit(std::string_view text, std::string_view unit) {
    text = trim(text);
    const auto length = number_length(text);
    const auto number = read_number(text.substr(0, length));
    const auto from = UnitReader(trim(text.substr(length))).read(), to = UnitReader(trim(unit)).read();
    if (!number || !from || !to || from->dimension != to->dimension) return {};
    const double value = apply(*from, *number) / apply(*to, 1);
    if (!std::isfinite(value)) return {};
    return value;
}

std::string with_unit(std::string_view text, const Unit& unit) {
    text = trim(text);
    std::string out(text);
    const bool plain = number_length(text) == text.size() && !text.empty();
    if (plain && !unit.si.empty()) out += " " + std::string(unit.si);
    return out;
}

} // namespace treacle
