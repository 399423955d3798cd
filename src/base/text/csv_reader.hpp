#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace treacle {

// A table of numbers as CsvTable writes it, in memory.
struct CsvColumns {
    std::filesystem::path path;
    std::vector<std::string> names;          // with units, "time [s]"
    std::vector<std::vector<double>> values; // one list of rows a column

    // Throws InputError with the names that there are.
    const std::vector<double>& column(const std::string& name) const;
    // The column of this name, with or without its unit; null when there is none.
    const std::vector<double>* find(const std::string& name) const;
    std::size_t rows() const { return values.empty() ? 0 : values.front().size(); }
};

// Reads it; a last row that was cut off is left out, and what is no number becomes NaN. Throws InputError for a file that
// cannot be read, and for a row whose number of values is not that of the header.
CsvColumns read_csv(const std::filesystem::path& path);

// "front" of "front [m]".
std::string without_unit(const std::string& column);

} // namespace treacle
