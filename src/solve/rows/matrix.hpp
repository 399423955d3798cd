#pragma once
#include "mpi/row_halo.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

namespace treacle::solve {

// Integer of the row offsets and column numbers: PETSc's own (32 bits in Debian's).
using Index = int;

// This rank's rows of a distributed sparse matrix in two parts: columns owned by this rank, and the others.
// Pointers only; the arrays belong to the caller and must outlive the Matrix. Columns rise within each row.
// Every row holds its diagonal entry, even where it is zero.
struct CsrBlocks {
    Index* diagonal_offsets = nullptr; // [rows + 1], from 0
    Index* diagonal_columns = nullptr; // local: 0 … rows - 1
    double* diagonal_values = nullptr; // [diagonal_offsets[rows]]
    Index* off_offsets = nullptr;      // [rows + 1], from 0
    Index* off_columns = nullptr;      // places in halo->columns()
    double* off_values = nullptr;      // [off_offsets[rows]]
    RowHalo* halo = nullptr;           // connected to the other ranks' columns; null: nothing to exchange
    Index first_row = 0;               // global number of this rank's first row
    Index rows = 0;                    // rows on this rank, may be 0
    Index global_rows = 0;

    // Diagonal entry of a row, which every row has.
    double& diagonal(Index row) const {
        Index k = diagonal_offsets[row];
        while (diagonal_columns[k] != row) ++k;
        return diagonal_values[k];
    }
};

// Throws std::logic_error, naming the row, when the pattern breaks the rules above. Local.
void check_pattern(const CsrBlocks& given);

// A square distributed matrix around the caller's arrays, without a copy: a value changed there is
// changed here. Making one costs nothing; PETSc's own, of which preconditioners of PETSc and HYPRE are made, comes
// into being at their first use, at the cost of 1 to 3 products.
class Matrix {
public:
    // Debug builds check the pattern first, collectively.
    Matrix(const Comm& comm, const CsrBlocks& given);
    ~Matrix();
    Matrix(Matrix&&) noexcept;
    Matrix& operator=(Matrix&&) noexcept;

    // Term that products add to those of the stored entries: y += B x on this rank's rows, collective if the caller's
    // is, B symmetric and positive semidefinite. Preconditioners are built from the stored entries only.
    using Addition = std::function<void(std::span<const double> x, std::span<double> y)>;
    void set_matrix_free_term(Addition addition) { addition_ = std::move(addition); }

    // For algebraic multigrid: rows belong together by so many, and these vectors, on this rank's rows, are the near
    // null space of A, such as the rigid motions of an elastic body. Before a preconditioner is made.
    void set_blocks(int size, std::vector<std::vector<double>> near_null_space) {
        block_size_ = size;
        near_null_space_ = std::move(near_null_space);
    }

    // Matrices are taken to be symmetric unless this is called, before a preconditioner is made.
    void set_unsymmetric() { symmetric_ = false; }
    bool symmetric() const { return symmetric_; }

    // y = A x on this rank's rows. Collective.
    void multiply(std::span<const double> x, std::span<double> y) const;
    // To be called after values were changed in the caller's arrays, the pattern being the same: what
    // preconditioners derived from the old values is then renewed. Collective.
    void values_changed();

    // Ranks and size: global number of this rank's first row, rows of this rank and of all.
    const Comm& comm() const { return comm_; }
    Index first_row() const { return first_row_; }
    Index rows() const { return rows_; }
    Index global_rows() const { return global_rows_; }
    // Another number for each matrix, and after each change of values.
    std::int64_t revision() const { return revision_; }
    // Stored entries on this rank.
    std::int64_t entries() const { return entries_; }
    const CsrBlocks& blocks() const { return blocks_; }

    // PETSc's, made by the first call, which is collective.
    struct Native;
    Native& native();

private:
    Comm comm_;
    CsrBlocks blocks_;
    Index first_row_;
    Index rows_;
    Index global_rows_;
    std::int64_t entries_;
    Addition addition_;
    std::int64_t revision_;
    int block_size_ = 1;
    bool symmetric_ = true;
    std::vector<std::vector<double>> near_null_space_;
    std::unique_ptr<Native> native_;
};

} // namespace treacle::solve
