#pragma once
#include "solve/rows/matrix.hpp"

#include <optional>
#include <vector>

namespace treacle::solve {

// This rank's rows of a distributed matrix of dense square blocks, by their global numbers: each rank has a
// contiguous range of them, in rank order. Columns rise within a row; every row has its own block.
struct BlockRows {
    int size = 1;                  // numbers a side of a block
    Index first = 0;               // this rank's first row
    std::vector<Index> offsets{0}; // [rows + 1]
    std::vector<Index> columns;    // [offsets.back()]
    std::vector<double> values;    // [offsets.back()][size][size]

    // Rows of blocks on this rank, and membership by global number.
    Index rows() const { return static_cast<Index>(offsets.size()) - 1; }
    bool owns(Index block) const { return block >= first && block < first + rows(); }
};

// The same number by number, as a Matrix takes it, with the halo of its columns.
class BlockMatrix {
public:
    BlockMatrix() = default;
    BlockMatrix(const BlockMatrix&) = delete; // blocks_ points into it
    BlockMatrix& operator=(const BlockMatrix&) = delete;

    // Collective. SimulationError where this rank's entries are more than an Index can count.
    void build(const Comm& comm, const BlockRows& rows);
    // Matrix of the arrays of this object; null before build().
    Matrix* matrix() { return matrix_ ? &*matrix_ : nullptr; }
    const CsrBlocks& blocks() const { return blocks_; }
    void clear() { matrix_.reset(); }
    std::size_t bytes() const;

private:
    struct Part {
        std::vector<Index> offsets, columns;
        std::vector<double> values;
        void reserve(std::size_t rows, std::size_t entries);
    };
    void connect(const Comm& comm, const BlockRows& rows);
    void append(const BlockRows& rows, Index block, int line);

    Part own_, other_;
    std::vector<int> halo_columns_; // scratch of connect()
    RowHalo halo_;
    CsrBlocks blocks_;
    std::optional<Matrix> matrix_;
};

} // namespace treacle::solve
