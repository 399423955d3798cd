#pragma once
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace treacle::video {

// A small CSV file of numbers under a header; units in brackets behind a name do not count: "time [s]" is "time".
struct NumberTable {
    std::filesystem::path path;
    std::map<std::string, std::vector<double>> columns;

    // InputError that lists the columns when there is no such one.
    const std::vector<double>& column(const std::string& name) const;
};

// InputError with file and line for what is no number and for rows of unlike lengths.
NumberTable read_number_table(const std::filesystem::path& path);

} // namespace treacle::video
