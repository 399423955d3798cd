#pragma once
#include "study/lanes/journal.hpp"

#include <span>

namespace treacle::study {

// A study's runs as a table: a row a run in the order of the requests, with its number, scene, the parameters' values,
// its status, figures, seconds [s] and the reason where it has none, or what it changes after the parameters.
struct Table {
    std::vector<std::string> header;
    std::vector<std::vector<std::string>> rows;
    std::vector<std::string> figures; // which of the columns are figures
};
Table table_of(const Study& study, const Journal& journal, std::span<const std::int64_t> runs);

// RFC 4180: words with a comma, a quote or a line break in quotes. Replaced as a whole. Throws SimulationError.
void write_table(const std::filesystem::path& path, const Table& table);

// The column's values as numbers; what is none is not a number.
std::vector<double> numbers_of(const Table& table, const std::string& column);

// Lines with columns of even width, for a terminal.
std::vector<std::string> lines_of(const Table& table);

} // namespace treacle::study
