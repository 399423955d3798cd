#pragma once
#include "solve/rows/matrix.hpp"

namespace treacle::solve {

// This rank's numbers among the rows of a distributed matrix.
struct RowRange {
    std::int64_t first = 0;
    int rows = 0;
    std::int64_t global = 0;
};

// The rows whose entries stand in arrays in host memory: `own` the columns of this rank, `other` those of the halo. Each has
// offset [rows + 1], column and value. Nothing is copied.
template <class HostBlock>
CsrBlocks csr_blocks(const HostBlock& own, const HostBlock& other, RowHalo& halo, const RowRange& range) {
    CsrBlocks blocks;
    blocks.diagonal_offsets = own.offset.data();
    blocks.diagonal_columns = own.column.data();
    blocks.diagonal_values = own.value.data();
    blocks.off_offsets = other.offset.data();
    blocks.off_columns = other.column.data();
    blocks.off_values = other.value.data();
    blocks.halo = &halo;
    blocks.first_row = static_cast<Index>(range.first);
    blocks.rows = range.rows;
    blocks.global_rows = static_cast<Index>(range.global);
    return blocks;
}

} // namespace treacle::solve
