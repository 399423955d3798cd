#include "video/scene_points.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>

namespace treacle::video {

namespace {

constexpr const char* example = "write a header such as x [cm], y [cm], z [cm], u, v and a line for each point";

[[noreturn]] void refuse(const std::string& where, const std::string& problem, const std::string& reason = "",
                         const std::string& cure = example) {
    throw InputError({where, problem, reason, cure});
}

struct Column {
    std::string name;
    double factor = 1; // to metres
};

// Words between commas, semicolons, tabs or, where there are none of these, blanks; brackets stay with their name.
std::vector<std::string> split(const std::string& line) {
    const bool marked = line.find_first_of(",;\t") != std::string::npos;
    std::vector<std::string> out{""};
    bool bracket = false;
    for (const char c : line) {
        bracket = c == '[' || (bracket && c != ']');
        const bool ends = marked ? c == ',' || c == ';' || c == '\t' : c == ' ' && !bracket;
        if (ends) {
            out.emplace_back();
        } else {
            out.back() += c;
        }
    }
    for (auto& word : out) {
        word.erase(0, word.find_first_not_of(" \r"));
        word.erase(word.find_last_not_of(" \r") + 1);
    }
    if (!marked) std::erase(out, "");
    if (!marked) // "x [cm]" came apart at its blank
        for (std::size_t i = 1; i < out.size();) {
            if (!out[i].starts_with("[")) {
                ++i;
                continue;
            }
            out[i - 1] += " " + out[i];
            out.erase(out.begin() + std::ptrdiff_t(i));
        }
    return out;
}

Column column_of(const std::string& word, const std::string& where) {
    Column out;
    const auto bracket = word.find('[');
    out.name = word.substr(0, bracket);
    out.name.erase(out.name.find_last_not_of(' ') + 1);
    const std::string unit_text = bracket == std::string::npos ? "" : word.substr(bracket + 1, word.find(']') - bracket - 1);
    const bool length = out.name == "x" || out.name == "y" || out.name == "z";
    if (length && !unit_text.empty()) {
        const auto read = read_quantity("1 " + unit_text, unit::length);
        if (const auto* complaint = std::get_if<Complaint>(&read)) refuse(where, "[" + unit_text + "] " + complaint->must, complaint->reason, complaint->cure);
        out.factor = std::get<double>(read);
    }
    return out;
}

double value_of(const std::string& word, const std::string& where) {
    const auto value = read_number(word);
    if (!value || !std::isfinite(*value)) refuse(where, "\"" + word + "\" is no number", "", "write numbers; units stand in the header");
    return *value;
}

} // namespace

std::vector<ScenePoint> read_scene_points(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) refuse(path.string(), "there is no such file of points");
    std::vector<ScenePoint> out;
    std::vector<Column> columns;
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        const auto where = path.string() + ":" + std::to_string(number);
        const auto first = line.find_first_not_of(" \t\r");
        if (first == std::string::npos || line[first] == '#') continue;
        const auto words = split(line);
        if (columns.empty()) {
            for (const auto& word : words) columns.push_back(column_of(word, where));
            for (const auto* name : {"x", "y", "z", "u", "v"})
                if (std::ranges::find(columns, name, &Column::name) == columns.end()) refuse(where, std::string("the column ") + name + " is missing");
            continue;
        }
        if (words.size() != columns.size())
            refuse(where, "has " + std::to_string(words.size()) + " values, the header " + std::to_string(columns.size()));
        ScenePoint point;
        point.where = where;
        for (std::size_t i = 0; i < words.size(); ++i) {
            const auto& [name, factor] = columns[i];
            if (name.size() != 1 || std::string("xyzuvs").find(name) == std::string::npos) continue;
            const double value = factor * value_of(words[i], where);
            if (name >= "x") point.position[std::size_t(name[0] - 'x')] = value;
            if (name == "u") point.pixel[0] = value;
            if (name == "v") point.pixel[1] = value;
            if (name == "s") point.deviation = value;
        }
        if (point.deviation < 0) refuse(where, "s = " + format_number(point.deviation) + ": must be > 0", "it is a standard deviation");
        out.push_back(point);
    }
    if (columns.empty()) refuse(path.string(), "is empty");
    return out;
}

} // namespace treacle::video
