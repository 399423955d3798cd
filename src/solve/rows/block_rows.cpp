#include "solve/rows/block_rows.hpp"

#include "base/text/error.hpp"

#include <algorithm>
#include <limits>

namespace treacle::solve {

void BlockMatrix::Part::reserve(std::size_t rows, std::size_t entries) {
    offsets.assign(1, 0);
    offsets.reserve(rows + 1);
    columns.clear();
    columns.reserve(entries);
    values.clear();
    values.reserve(entries);
}

void BlockMatrix::connect(const Comm& comm, const BlockRows& rows) {
    halo_columns_.clear();
    for (const Index block : rows.columns) {
        if (!rows.owns(block)) halo_columns_.push_back(block);
    }
    std::sort(halo_columns_.begin(), halo_columns_.end());
    halo_columns_.erase(std::unique(halo_columns_.begin(), halo_columns_.end()), halo_columns_.end());
    std::vector<int> columns;
    for (const int block : halo_columns_) {
        for (int k = 0; k < rows.size; ++k) columns.push_back(rows.size * block + k);
    }
    halo_.connect(comm, std::int64_t(rows.size) * rows.first, columns);
}

// One line of numbers of a row of blocks.
void BlockMatrix::append(const BlockRows& rows, Index block, int line) {
    const int m = rows.size;
    for (Index entry = rows.offsets[block]; entry < rows.offsets[block + 1]; ++entry) {
        const Index column = rows.columns[entry];
        const bool mine = rows.owns(column);
        const auto local_column =
            mine ? column - rows.first
                 : static_cast<Index>(
                       std::lower_bound(halo_columns_.begin(), halo_columns_.end(), column) - halo_columns_.begin());
        const double* values =
            &rows.values[static_cast<std::size_t>(entry) * std::size_t(m * m) + std::size_t(m * line)];
        Part& part = mine ? own_ : other_;
        for (int l = 0; l < m; ++l) {
            part.columns.push_back(m * local_column + l);
            part.values.push_back(values[l]);
        }
    }
    for (Part* part : {&own_, &other_}) part->offsets.push_back(static_cast<Index>(part->columns.size()));
}

void BlockMatrix::build(const Comm& comm, const BlockRows& rows) {
    matrix_.reset();
    comm.guard([&] {
        if (rows.values.size() <= static_cast<std::size_t>(std::numeric_limits<Index>::max())) return;
        throw SimulationError({"assembled matrix", std::to_string(rows.values.size()) + " entries on one rank",
            "their numbers have 32 bits", "take more ranks, or products without a matrix"});
    });
    connect(comm, rows);
    const auto lines = std::size_t(rows.size) * static_cast<std::size_t>(rows.rows());
    own_.reserve(lines, rows.values.size());
    other_.reserve(lines, 0);
    for (Index block = 0; block < rows.rows(); ++block) {
        for (int line = 0; line < rows.size; ++line) append(rows, block, line);
    }
    blocks_ = {own_.offsets.data(), own_.columns.data(), own_.values.data(), other_.offsets.data(),
        other_.columns.data(), other_.values.data(), &halo_, rows.size * rows.first, static_cast<Index>(lines), 0};
    blocks_.global_rows = static_cast<Index>(comm.sum(std::int64_t(lines)));
    matrix_.emplace(comm, blocks_);
}

std::size_t BlockMatrix::bytes() const {
    std::size_t out = halo_.bytes();
    for (const Part* part : {&own_, &other_}) {
        out += sizeof(Index) * (part->offsets.capacity() + part->columns.capacity()) +
               sizeof(double) * part->values.capacity();
    }
    return out;
}

} // namespace treacle::solve
