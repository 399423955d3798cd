#include "app/input/option_values.hpp"

#include "base/text/error.hpp"

#include <array>
#include <sstream>

namespace treacle::app {

double read_length(const std::string& option, const std::string& text) {
    const auto read = read_quantity(text, unit::length);
    if (const auto* complaint = std::get_if<Complaint>(&read))
        throw InputError({option + " " + text, complaint->must, complaint->reason, complaint->cure});
    const double length = std::get<double>(read);
    if (!(length > 0))
        throw InputError({option + " " + text, "must be > 0", "it is a length", "measure it with calipers"});
    return length;
}

double read_wall_limit(const std::string& text) {
    if (text.empty()) return 0;
    const auto read = read_quantity(text, unit::time);
    if (const auto* complaint = std::get_if<Complaint>(&read)) {
        throw InputError({"--wall-limit " + text, complaint->must, complaint->reason, complaint->cure});
    }
    const double seconds = std::get<double>(read);
    if (seconds > 0) return seconds;
    throw InputError({"--wall-limit " + text, "must be > 0", "it is a length of time", "write for instance 2h"});
}

Vec3 read_vector(const std::string& text, const Unit& unit, const std::string& option) {
    std::istringstream words(text);
    std::array<std::string, 3> parts;
    std::string unit_text;
    words >> parts[0] >> parts[1] >> parts[2] >> unit_text;
    Vec3 out{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k) {
        const auto read = read_quantity(parts[k] + (unit_text.empty() ? "" : " " + unit_text), unit);
        if (const auto* complaint = std::get_if<Complaint>(&read))
            throw InputError({option + " \"" + text + "\"", complaint->must, complaint->reason,
                "write three numbers, as in \"10 0 5 cm\""});
        out[k] = std::get<double>(read);
    }
    return out;
}

std::vector<std::string> split_at(const std::string& text, char mark) {
    std::vector<std::string> parts{""};
    for (const char c : text) {
        if (c == mark)
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

} // namespace treacle::app
