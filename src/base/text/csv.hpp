#pragma once
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace treacle {

// A table that grows by rows: a header with units in its names ("time [s]"), comma separated, every number
// with as many digits as it takes to read the same double back. Only one rank holds one.
class CsvTable {
public:
    // Starts a new file, or replaces an old one. Throws SimulationError when it cannot be written, and
    // InputError for a column name with a comma, a quote or a line break.
    static CsvTable create(const std::filesystem::path& path, std::vector<std::string> columns);

    // Goes on with an existing file: keeps the rows whose first column, the step, is <= `last_step`, drops
    // the others and a last row that was cut off. Starts a new file when there is none. Throws InputError
    // when its header is not `columns`.
    static CsvTable resume(const std::filesystem::path& path, std::vector<std::string> columns, std::int64_t last_step);

    // One number per column, else std::invalid_argument. Throws SimulationError when the disk is full.
    void append(std::span<const double> row);
    void flush();
    // Flushes, and blocks until the disk has the rows. Throws as append().
    void sync();

    const std::vector<std::string>& columns() const { return columns_; } // header, with units
    // Last row that resume() kept; empty when there was none.
    const std::vector<double>& last_row() const { return last_row_; }

private:
    struct Close {
        void operator()(std::FILE* file) const { std::fclose(file); }
    };
    CsvTable(const std::filesystem::path& path, std::vector<std::string> columns);

    std::filesystem::path path_;
    std::vector<std::string> columns_;
    std::unique_ptr<std::FILE, Close> file_;
    std::string line_;
    std::vector<double> last_row_;
};

} // namespace treacle
