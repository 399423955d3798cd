#pragma once
#include "base/text/units.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace treacle::video {

// A small table of numbers under a header of names, each perhaps with its unit in brackets: "time [ms]". Commas, semicolons,
// tabs or, where there are none of these, blanks between the values; lines that begin with # do not count.
class NumberTable {
public:
    // InputError with file and line for a file that cannot be read, without a header, and for rows of unlike lengths.
    explicit NumberTable(const std::filesystem::path& path);

    bool has(const std::string& name) const; // name without the unit and its brackets
    // Values in SI by the unit of the header, without one in that of `unit`; pixels count as plain numbers. InputError when
    // there is no such column, for a unit of another dimension and, with its line, for what is no finite number.
    std::vector<double> column(const std::string& name, const Unit& unit) const;
    std::size_t rows() const { return lines_.size(); }
    std::string where(std::size_t row) const; // "points.csv:3"

private:
    struct Column {
        std::string name, unit;
        std::vector<std::string> values;
    };
    std::string where_line(int line) const { return path_.string() + ":" + std::to_string(line); }
    double factor(const Column& column, const Unit& unit) const;

    std::filesystem::path path_;
    std::vector<Column> columns_;
    int header_ = 0;         // line
    std::vector<int> lines_; // of the rows
};

} // namespace treacle::video
