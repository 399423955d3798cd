#pragma once
// Inside src/solve only: one level of a multilevel hierarchy.
#include "mpi/row_halo.hpp"
#include "solve/multigrid/block_sweeps.hpp"
#include "solve/rows/matrix.hpp"
#include "solve/rows/sparse_dot.hpp"

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace treacle::solve {

// Place of a cell along the Z-curve: eight cells in a row make the cell of twice the width.
using MortonKey = std::uint64_t;
MortonKey cell_key(const int cell[3]);
// Parity of the sum of the coordinates.
int colour(MortonKey key);
// The key of the cell beside; face: x-, x+, y-, y+, z-, z+.
MortonKey beside(MortonKey key, int face);

// Compressed rows: offsets [rows + 1], columns [entries]. Rows are appended: first their entries, then end_row().
struct Csr {
    std::vector<Index> offsets{0}, columns;
    std::vector<double> values; // [entries]

    // No rows; the memory is kept.
    void clear() {
        offsets.assign(1, 0);
        columns.clear();
        values.clear();
    }
    void end_row() { offsets.push_back(static_cast<Index>(columns.size())); }
    std::size_t bytes() const { // allocated [bytes]
        return 4 * (offsets.capacity() + columns.capacity()) + 8 * values.capacity();
    }
};

// This rank's rows of a coarse matrix as they are made: columns are global numbers.
struct CoarseRows {
    Csr matrix;
    std::vector<MortonKey> keys;
    std::vector<double> walls;   // for grids: what walls add to the diagonals
    std::vector<double> centres; // for rigid modes: [rows / modes][3], of the aggregates [m]
    int block = 1; // so many rows one after the other have the same columns, so many of which are one after the other

    // No rows; the memory is kept.
    void clear() {
        matrix.clear();
        keys.clear();
        walls.clear();
        centres.clear();
        block = 1;
    }
    Index rows() const { return static_cast<Index>(keys.size()); } // on this rank
};

// Rows of equal keys one after the other, in the order of the rows.
struct Run {
    MortonKey key;
    Index begin, end;
};

// Rows of a level times a vector, for kernels: this rank's columns, then those of others.
struct LevelProduct {
    RowProduct own, other;
    KOKKOS_INLINE_FUNCTION double operator()(int row) const {
        return other.is_empty(row) ? own(row) : own(row) + other(row);
    }
};

// One level: rows, their sweeps, and the aggregates that they form. Rows and spans are this rank's.
class Level {
public:
    // The matrix itself, after `fixed`. The level refers to it.
    void refer_to(const Matrix& matrix);
    // Collective. Takes the rows, whose numbers start at first in the order of the ranks.
    void take(const Comm& comm, CoarseRows& made, Index first, Index global_rows);

    // (RM3) Collective. Sweeps within the ranks' own rows reduce the error of any symmetric positive definite matrix only if
    // 2 D' - D - A_off is positive definite too, D' being what they divide by and A_off the couplings of different ranks.
    // (D + sum |A_off|) / 2 is enough, rows scaled to a unit diagonal. D' = D / relaxation within a rank, and more beside
    // others, whose values are constant during a sweep: D / relaxation + 1.5 (1 - 1 / relaxation) sum |A_off|.
    void set_l1_diagonal(double relaxation = 1);

    // (ML3) z = (D' + L)^-1 r, t = r - A z: one pass over half of the matrix.
    void sweep_forward_from_zero(std::span<const double> r, std::span<double> z, std::span<double> t);
    // Sweeps from z. The values of other ranks are those before the sweep.
    void sweep_forward(std::span<const double> r, std::span<double> z);
    void sweep_backward(std::span<const double> r, std::span<double> z);
    // The same, and t = r - A z of a symmetric A: in one pass over the matrix. Not where rows are fixed.
    void sweep_backward(std::span<const double> r, std::span<double> z, std::span<double> t);
    // Rows beside other ranks once more, with what these have come to: after sweep_forward_from_zero or sweep_forward, with its t, and
    // before sweep_backward.
    void sweep_interface_forward(std::span<double> z, std::span<double> t);
    void sweep_interface_backward(std::span<const double> r, std::span<double> z);
    // Collective: A z, row by row, for kernels; valid until the next exchange of the halo.
    LevelProduct product(std::span<const double> z) { return product(z, halo().gather(z)); }
    // Collective, a kernel: t = r - A z
    void residual(std::span<const double> r, std::span<const double> z, std::span<double> t);

    // Kernels between the level and its aggregates, which all are this rank's: coarse = P^T t, each sum in the order of the
    // rows; z += P coarse.
    void restrict_to(std::span<const double> t, std::span<double> coarse) const;
    void prolong(std::span<const double> coarse, std::span<double> z) const;

    // Rows where z stays 0; a_ii, which every row stores.
    bool is_fixed(std::size_t row) const { return !fixed.empty() && fixed[row] != 0; }
    double diagonal(Index row) const { return own_.values[diagonal_[static_cast<std::size_t>(row)]]; }
    // [rows] 1/D', D' = D before set_l1_diagonal(); 0 where z stays 0 and where there is nothing to divide by.
    std::span<const double> inverse_diagonal() const { return inverse_; }
    // Stored entries and memory [bytes] of this rank; the latter without a matrix that the level refers to.
    std::int64_t entries() const { return std::int64_t{own_.offsets[rows]} + other_.offsets[rows]; }
    std::size_t bytes() const;

    Index rows = 0, first_row = 0, global_rows = 0; // rows of this rank, global number of the first, of all ranks
    std::vector<MortonKey> keys;                    // [rows]; of the matrix itself, those of the finest cells
    std::vector<double> walls;                      // [rows], for grids
    std::vector<double> centres;                    // [rows / modes][3], for rigid modes
    std::vector<unsigned char> fixed;               // [rows] of the matrix itself, 1 where z stays 0; or empty
    std::vector<double> r, z, t;                    // of coarse levels; t of the matrix too
    std::pair<std::vector<double>, std::vector<double>> second; // of coarse levels, for a W-cycle

    // The aggregates of this level, which are this rank's rows of the next one before it is gathered.
    std::vector<Index> aggregate; // [rows], -1: none
    std::vector<Run> runs;        // aggregate a holds the rows of runs group[a] to group[a + 1] - 1
    std::vector<Index> group;
    Index aggregates() const { return static_cast<Index>(group.size()) - 1; }

    // Compressed rows of a matrix or of a Csr, referred to.
    struct Block {
        const Index* offsets = nullptr; // [rows + 1], from 0
        const Index* columns = nullptr; // [entries], rising within a row
        const double* values = nullptr; // [entries]
    };
    const Block& own() const { return own_; }     // columns are local rows
    const Block& other() const { return other_; } // columns are places in the halo
    // Columns of other ranks; after refer_to() the halo of the matrix.
    RowHalo& halo() { return borrowed_halo_ ? *borrowed_halo_ : halo_; }

private:
    LevelProduct product(std::span<const double> z, std::span<const double> around) const;
    void index_rows();
    double inverse(double diagonal, std::size_t row) const {
        return diagonal > 0 && !is_fixed(row) ? 1 / diagonal : 0.0;
    }
    void subtract_others(std::span<const double> around, std::span<double> t) const;
    void sweep_up_by_rows(std::span<const double> r, std::span<double> z, std::span<double> t);
    std::span<const double> less_others(std::span<const double> r, std::span<const double> around);

    Block own_, other_;
    Csr own_store_, other_store_;
    std::vector<Index> halo_columns_;    // scratch of take()
    std::vector<Index> diagonal_;        // place of the diagonal entry in own
    std::vector<Index> interface_;       // rows that couple to other ranks
    std::vector<double> change_;         // [rows], of sweep_interface_forward(): zero but for border rows
    std::vector<double> l1_diagonal_;    // [rows] D'; or empty: D
    std::vector<double> inverse_;        // of inverse_diagonal()
    std::vector<double> around_, right_; // scratch of sweep_backward()
    BlockSweeps blocks_;                 // where rows come in blocks, does their sweeps
    RowHalo halo_;
    RowHalo* borrowed_halo_ = nullptr; // the matrix's own
};

} // namespace treacle::solve
