#include "base/text/csv.hpp"

#include "base/text/error.hpp"
#include "base/text/file.hpp"
#include "base/text/text.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <unistd.h>

namespace treacle {

namespace {
[[noreturn]] void fail(const std::filesystem::path& path) {
    throw SimulationError(
        {path.string(), "cannot write", std::strerror(errno), "free some space or choose another folder with --out"});
}

std::string header(const std::filesystem::path& path, const std::vector<std::string>& columns) {
    for (const auto& column : columns) {
        if (column.find_first_of(",\"\n\r") == std::string::npos) continue;
        throw InputError({path.string(), "column \"" + column + "\" has a comma, a quote or a line break",
            "names become the header of the table", "choose a plainer name"});
    }
    return join(columns, ",") + "\n";
}

// Numbers of a line; text that is no number becomes NaN.
std::vector<double> numbers_of(const std::string& line) {
    std::vector<double> row;
    for (std::size_t from = 0; from <= line.size();) {
        const auto comma = std::min(line.find(',', from), line.size());
        row.push_back(read_number(line.substr(from, comma - from)).value_or(std::numeric_limits<double>::quiet_NaN()));
        from = comma + 1;
    }
    return row;
}
} // namespace

CsvTable::CsvTable(const std::filesystem::path& path, std::vector<std::string> columns)
    : path_(path), columns_(std::move(columns)), file_(std::fopen(path.c_str(), "a")) {
    if (!file_) fail(path_);
}

CsvTable CsvTable::create(const std::filesystem::path& path, std::vector<std::string> columns) {
    write_file_atomically(path, header(path, columns));
    return CsvTable(path, std::move(columns));
}

namespace {

[[noreturn]] void refuse_header(const std::filesystem::path& path) {
    throw InputError({path.string() + ":1", "the header is not the one that this run writes",
        "the file belongs to another scene or version", "move it away to start a new one"});
}

} // namespace

CsvTable CsvTable::resume(const std::filesystem::path& path, std::vector<std::string> columns, std::int64_t last_step) {
    std::ifstream old(path);
    if (!old) return create(path, std::move(columns));
    std::string kept = header(path, columns);
    std::string line;
    std::getline(old, line);
    if (line + "\n" != kept) refuse_header(path);
    std::string last;
    // A row without its line break was cut off: getline then ends at the end of the file.
    while (std::getline(old, line) && !old.eof()) {
        const auto step = read_number(line.substr(0, line.find(',')));
        if (step && *step <= static_cast<double>(last_step)) kept += (last = line) + "\n";
    }
    write_file_atomically(path, kept);
    CsvTable table(path, std::move(columns));
    if (!last.empty()) table.last_row_ = numbers_of(last);
    return table;
}

void CsvTable::append(std::span<const double> row) {
    if (row.size() != columns_.size()) {
        throw std::invalid_argument(path_.string() + ": " + std::to_string(row.size()) + " numbers for " +
                                    std::to_string(columns_.size()) + " columns");
    }
    line_.clear();
    for (const double value : row) line_ += (line_.empty() ? "" : ",") + format_number(value);
    line_ += '\n';
    if (std::fwrite(line_.data(), 1, line_.size(), file_.get()) != line_.size()) fail(path_);
}

void CsvTable::flush() {
    if (std::fflush(file_.get()) != 0) fail(path_);
}

void CsvTable::sync() {
    flush();
    if (::fsync(::fileno(file_.get())) != 0) fail(path_);
}

} // namespace treacle
