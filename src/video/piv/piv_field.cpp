#include "video/piv/piv_field.hpp"

#include "base/text/error.hpp"
#include "base/text/split.hpp"
#include "base/text/text.hpp"
#include "base/text/units.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

namespace treacle::video {

namespace {
constexpr double none = std::numeric_limits<double>::quiet_NaN();

struct Lines {
    std::filesystem::path path;
    std::vector<std::string> text;

    std::string where(std::size_t i) const { return path.string() + ":" + std::to_string(i + 1); }
};

Lines read_lines(const std::filesystem::path& path) {
    std::ifstream file(path);
    if (!file) throw InputError({path.string(), "cannot be read", "", "check its name"});
    Lines out{path, {}};
    for (std::string line; std::getline(file, line);) {
        if (!line.empty() && line.back() == '\r') line.pop_back();
        out.text.push_back(line);
    }
    return out;
}

std::string lower(std::string text) {
    for (auto& c : text) c = char(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

double number(std::string word, bool decimal_comma, const std::string& where) {
    if (decimal_comma) std::ranges::replace(word, ',', '.');
    if (lower(word) == "nan" || lower(word) == "-nan" || lower(word) == "+nan") return none;
    if (const auto value = read_number(word)) return *value;
    throw InputError({where, shorten(word) + " is no number", "a vector is expected here",
        "the file may be of another program, or damaged"});
}

// Columns of a vector.
struct Columns {
    std::size_t x = 0, y = 1, u = 2, v = 3, count = 4;
    std::vector<std::size_t> invalid_above_zero; // flags, mask
    std::size_t invalid_below_zero = 0;          // CHC; 0: none
    std::size_t valid = 0;                       // 0: none
    bool zeros_are_missing = false, decimal_comma = false, more_may_follow = false;
    std::string separators = " \t";
};

void read_rows(const Lines& lines, std::size_t first, const Columns& columns, PivField& out) {
    for (std::size_t i = first; i < lines.text.size(); ++i) {
        const auto words = split_words(lines.text[i], columns.separators);
        if (words.empty() || words.front().front() == '#') continue;
        if (words.size() < columns.count || (!columns.more_may_follow && words.size() > columns.count)) {
            throw InputError({lines.where(i), "has " + std::to_string(words.size()) + " values",
                std::to_string(columns.count) + " are expected", "the file may be cut off or damaged"});
        }
        const auto at = [&](std::size_t c) { return number(words[c], columns.decimal_comma, lines.where(i)); };
        const double u = at(columns.u), v = at(columns.v);
        bool valid = std::isfinite(u) && std::isfinite(v);
        for (const auto c : columns.invalid_above_zero) valid = valid && !(at(c) > 0);
        if (columns.invalid_below_zero > 0) valid = valid && !(at(columns.invalid_below_zero) < 0);
        if (columns.valid > 0) valid = valid && at(columns.valid) != 0;
        if (columns.zeros_are_missing) valid = valid && !(u == 0 && v == 0);
        out.x.push_back(at(columns.x));
        out.y.push_back(at(columns.y));
        out.u.push_back(u);
        out.v.push_back(v);
        out.valid.push_back(valid ? 1 : 0);
    }
    if (out.x.empty())
        throw InputError({lines.path.string(), "holds no vector", "its format is taken for that of " + out.format,
            "check the file"});
}

// The texts between quotes.
std::vector<std::string> quoted(const std::string& line) {
    std::vector<std::string> out;
    for (auto open = line.find('"'); open != std::string::npos;) {
        const auto close = line.find('"', open + 1);
        if (close == std::string::npos) break;
        out.push_back(line.substr(open + 1, close - open - 1));
        open = line.find('"', close + 1);
    }
    return out;
}

PivField read_davis(const Lines& lines) {
    PivField out;
    out.format = "DaVis";
    const auto words = quoted(lines.text.front()); // "position" "mm" "position" "mm" "velocity" "m/s"
    for (std::size_t i = 0; i + 1 < words.size(); i += 2) {
        if (lower(words[i]) == "position") out.length_unit = words[i + 1];
        if (lower(words[i]) == "velocity") out.velocity_unit = words[i + 1];
    }
    Columns columns;
    columns.decimal_comma = columns.zeros_are_missing = true;
    columns.separators = " \t;";
    read_rows(lines, 1, columns, out);
    return out;
}

std::string unit_behind(const std::string& variable) { // "X pixel", "U m/s"
    const auto blank = variable.find(' ');
    return blank == std::string::npos ? "" : variable.substr(blank + 1);
}

PivField read_insight(const Lines& lines) {
    PivField out;
    out.format = "Insight";
    const auto& head = lines.text.front();
    const auto from = head.find("VARIABLES=");
    if (from == std::string::npos)
        throw InputError({lines.where(0), "names no VARIABLES", "a file of Insight does", "check the file"});
    const auto to = std::min(head.find("DATASETAUXDATA", from), head.find("ZONE", from));
    const auto names = quoted(head.substr(from, to == std::string::npos ? to : to - from));
    Columns columns;
    columns.count = names.size();
    columns.separators = ", \t";
    bool found[4] = {};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto name = lower(names[i].substr(0, names[i].find(' ')));
        const auto take = [&](const char* wanted, std::size_t& column, int k) {
            if (name != wanted) return;
            column = i;
            found[k] = true;
        };
        take("x", columns.x, 0);
        take("y", columns.y, 1);
        take("u", columns.u, 2);
        take("v", columns.v, 3);
        if (name == "chc") columns.invalid_below_zero = i;
    }
    for (const bool one : found) {
        if (!one)
            throw InputError(
                {lines.where(0), "lacks one of X, Y, U, V", "its variables are " + join(names, ", "), "export them"});
    }
    out.length_unit = unit_behind(names[columns.x]);
    out.velocity_unit = unit_behind(names[columns.u]);
    read_rows(lines, 1, columns, out);
    return out;
}

// A header of names, perhaps with units in brackets.
PivField read_named(const Lines& lines, std::size_t header, const std::string& separators, const std::string& format) {
    PivField out;
    out.format = format;
    auto head = lines.text[header];
    head.erase(0, std::min(head.find_first_not_of("# \t"), head.size()));
    // A blank before a bracket belongs to the column's name.
    auto names = split_words(head, separators == " \t" && head.find('[') != std::string::npos ? "\t" : separators);
    Columns columns;
    columns.count = names.size();
    columns.separators = separators;
    bool found[4] = {};
    for (std::size_t i = 0; i < names.size(); ++i) {
        const auto bracket = names[i].find('[');
        auto name = lower(names[i].substr(0, bracket));
        name.erase(name.find_last_not_of(" \t") + 1);
        name.erase(0, std::min(name.find_first_not_of(" \t"), name.size()));
        const auto unit =
            bracket == std::string::npos ? "" : names[i].substr(bracket + 1, names[i].find(']', bracket) - bracket - 1);
        const auto take = [&](const char* wanted, std::size_t& column, int k) {
            if (name != wanted) return false;
            column = i;
            found[k] = true;
            return true;
        };
        if (take("x", columns.x, 0)) out.length_unit = unit;
        take("y", columns.y, 1);
        if (take("u", columns.u, 2)) out.velocity_unit = unit;
        take("v", columns.v, 3);
        if (name == "flags" || name == "mask") columns.invalid_above_zero.push_back(i);
        if (name == "valid") columns.valid = i;
    }
    for (const bool one : found) {
        if (!one) {
            throw InputError({lines.where(header), "has no columns x, y, u and v", "it names " + join(names, ", "),
                "write for instance x [mm],y [mm],u [m/s],v [m/s]"});
        }
    }
    read_rows(lines, header + 1, columns, out);
    return out;
}

PivField read_bare(const Lines& lines, std::size_t first) {
    PivField out;
    out.format = "OpenPIV without header";
    Columns columns;
    columns.more_may_follow = true; // the ratio of signal and noise
    read_rows(lines, first, columns, out);
    return out;
}

// SI value of a unit of this dimension; nothing for another one.
std::optional<double> factor_of(const std::string& text, const Unit& unit) {
    const auto read = read_quantity("1 " + text, unit);
    if (const auto* value = std::get_if<double>(&read)) return *value;
    return {};
}

bool is_pixels(const std::string& unit) {
    const auto name = lower(unit);
    return name == "px" || name == "pixel" || name == "pixels" || name == "px/frame" || name == "pixel/frame" ||
           name == "pixels/frame";
}
} // namespace

std::size_t PivField::count_valid() const { return std::size_t(std::ranges::count(valid, 1)); }

PivField read_piv_text(const std::filesystem::path& path) {
    const auto lines = read_lines(path);
    std::size_t first = 0;
    while (first < lines.text.size() && lines.text[first].find_first_not_of(" \t") == std::string::npos) ++first;
    if (first == lines.text.size()) throw InputError({path.string(), "is empty", "", "give a file with vectors"});
    const auto& line = lines.text[first];
    if (line.starts_with("#DaVis")) return read_davis(lines);
    if (line.starts_with("TITLE=")) return read_insight(lines);
    if (line.starts_with("#")) return read_named(lines, first, " \t", "OpenPIV");
    const auto start = line.find_first_not_of(" \t");
    const bool numeric = std::isdigit(static_cast<unsigned char>(line[start])) || line[start] == '-' ||
                         line[start] == '+' || line[start] == '.';
    if (numeric) return read_bare(lines, first);
    for (const char* separator : {",", ";", "\t"}) {
        if (line.find(*separator) != std::string::npos) return read_named(lines, first, separator, "CSV");
    }
    throw InputError({lines.where(first), "is no header of a file with velocities", "it begins with " + shorten(line),
        "text of DaVis, Insight and OpenPIV is read, and CSV with columns x, y, u, v"});
}

PivField in_si(PivField field, const PivScale& scale, const std::string& where) {
    const auto refuse = [&](const std::string& problem, const std::string& cure) -> double {
        throw InputError({where, problem, "velocities are compared in m/s", cure});
    };
    const bool pixels = is_pixels(field.length_unit), pixel_speed = is_pixels(field.velocity_unit);
    if (field.length_unit.empty() || field.velocity_unit.empty()) {
        if (!(scale.pixel > 0 && scale.interval > 0)) {
            refuse("does not say its units", "state the size of a pixel and the interval of the frames, if they are "
                                             "pixels; else write a CSV with units");
        }
    } else if ((pixels || pixel_speed) && !(scale.pixel > 0)) {
        refuse("is in pixels, whose size is not given", "state the length of a pixel");
    } else if (pixel_speed && !(scale.interval > 0)) {
        refuse("has displacements in pixels, and the interval of the frames is not given",
            "state the time between the two pictures of a pair");
    }
    const bool bare = field.length_unit.empty() || field.velocity_unit.empty();
    const auto length = bare || pixels ? std::optional(scale.pixel) : factor_of(field.length_unit, unit::length);
    const auto speed = bare || pixel_speed ? std::optional(scale.pixel / scale.interval)
                                           : factor_of(field.velocity_unit, unit::velocity);
    const double by_length =
        length ? *length
               : refuse("has places in " + field.length_unit + ", which is no length", "export them in mm or pixels");
    const double by_speed = speed ? *speed
                                  : refuse("has velocities in " + field.velocity_unit + ", which is no velocity",
                                        "export them in m/s or pixels");
    for (auto* list : {&field.x, &field.y}) {
        for (auto& value : *list) value *= by_length;
    }
    for (auto* list : {&field.u, &field.v}) {
        for (auto& value : *list) value *= by_speed;
    }
    field.length_unit = "m";
    field.velocity_unit = "m/s";
    return field;
}

namespace {

// Length of the second difference of a vector over three fields [m/s].
double bend_of(const PivField& before, const PivField& now, const PivField& after, std::size_t i) {
    const double du = after.u[i] - 2 * now.u[i] + before.u[i], dv = after.v[i] - 2 * now.v[i] + before.v[i];
    return std::hypot(du, dv);
}

} // namespace

std::size_t reject_sudden(std::vector<PivField>& frames, double change, double floor) {
    if (frames.size() < 3) return 0;
    std::vector<std::vector<std::uint8_t>> verdicts;
    std::size_t marked = 0;
    for (std::size_t f = 0; f < frames.size(); ++f) {
        const auto middle = std::clamp<std::size_t>(f, 1, frames.size() - 2);
        const auto &before = frames[middle - 1], &now = frames[middle], &after = frames[middle + 1];
        auto verdict = frames[f].valid;
        for (std::size_t i = 0; i < verdict.size(); ++i) {
            if (!verdict[i] || !before.valid[i] || !now.valid[i] || !after.valid[i]) continue;
            const double limit = change * std::hypot(frames[f].u[i], frames[f].v[i]) + floor;
            if (bend_of(before, now, after, i) < limit) continue;
            verdict[i] = 0;
            ++marked;
        }
        verdicts.push_back(std::move(verdict));
    }
    for (std::size_t f = 0; f < frames.size(); ++f) frames[f].valid = std::move(verdicts[f]);
    return marked;
}

} // namespace treacle::video
