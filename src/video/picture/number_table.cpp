#include "video/picture/number_table.hpp"

#include "base/text/error.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

namespace treacle::video {

namespace {
std::string trimmed(std::string text) {
    text.erase(0, text.find_first_not_of(" \t\r"));
    text.erase(text.find_last_not_of(" \t\r") + 1);
    return text;
}

// Words between the marks, else between blanks; a unit in brackets stays with its name.
std::vector<std::string> split(const std::string& line) {
    const bool marked = line.find_first_of(",;\t") != std::string::npos;
    std::vector<std::string> out{""};
    bool bracket = false;
    for (const char c : line) {
        bracket = c == '[' || (bracket && c != ']');
        if (marked ? c == ',' || c == ';' || c == '\t' : c == ' ' && !bracket)
            out.emplace_back();
        else
            out.back() += c;
    }
    for (auto& word : out) word = trimmed(word);
    if (marked) return out;
    std::erase(out, "");
    for (std::size_t i = 1; i < out.size();) { // "x [cm]" came apart at its blank
        if (!out[i].starts_with("[")) {
            ++i;
            continue;
        }
        out[i - 1] += " " + out[i];
        out.erase(out.begin() + std::ptrdiff_t(i));
    }
    return out;
}
} // namespace

NumberTable::NumberTable(const std::filesystem::path& path) : path_(path) {
    std::ifstream file(path);
    if (!file) throw InputError({path.string(), "cannot be read", "", "check its name"});
    std::string line;
    for (int number = 1; std::getline(file, line); ++number) {
        line = trimmed(line);
        if (line.empty() || line.front() == '#') continue;
        const auto words = split(line);
        if (columns_.empty()) {
            header_ = number;
            for (const auto& word : words) {
                const auto bracket = word.find('['), end = word.find(']');
                columns_.push_back({trimmed(word.substr(0, bracket)),
                    bracket == std::string::npos ? "" : trimmed(word.substr(bracket + 1, end - bracket - 1)), {}});
            }
            continue;
        }
        if (words.size() != columns_.size())
            throw InputError({where_line(number), "has " + std::to_string(words.size()) + " values",
                "the header names " + std::to_string(columns_.size()), "give one for each column"});
        lines_.push_back(number);
        for (std::size_t i = 0; i < words.size(); ++i) columns_[i].values.push_back(words[i]);
    }
    if (columns_.empty()) throw InputError({path.string(), "is empty", "", "name the columns in the first line"});
}

bool NumberTable::has(const std::string& name) const {
    return std::ranges::find(columns_, name, &Column::name) != columns_.end();
}

std::string NumberTable::where(std::size_t row) const { return where_line(lines_[row]); }

double NumberTable::factor(const Column& column, const Unit& unit) const {
    if (column.unit.empty()) return 1;
    if (unit.si.empty()) {
        if (column.unit == "px" || column.unit == "pixels" || column.unit == "pixel") return 1;
        throw InputError({where_line(header_), column.name + " [" + column.unit + "] must be a plain number",
            "it has no unit", "leave the brackets out"});
    }
    const auto read = read_quantity("1 " + column.unit, unit);
    if (const auto* complaint = std::get_if<Complaint>(&read))
        throw InputError({where_line(header_), column.name + " [" + column.unit + "] " + complaint->must,
            complaint->reason, complaint->cure});
    return std::get<double>(read);
}

std::vector<double> NumberTable::column(const std::string& name, const Unit& unit) const {
    const auto found = std::ranges::find(columns_, name, &Column::name);
    if (found == columns_.end()) {
        std::vector<std::string> names;
        for (const auto& column : columns_) names.push_back(column.name);
        throw InputError({where_line(header_), "the column " + name + " is missing",
            "its columns are " + join(names, ", "), "name the columns in the first line"});
    }
    const double scale = factor(*found, unit);
    std::vector<double> out;
    for (std::size_t row = 0; row < rows(); ++row) {
        const auto value = read_number(found->values[row]);
        if (!value || !std::isfinite(*value))
            throw InputError({where(row), "\"" + shorten(found->values[row]) + "\" is no number", "",
                "write numbers; units stand in the header"});
        out.push_back(scale * *value);
    }
    return out;
}

} // namespace treacle::video
