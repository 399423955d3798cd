#pragma once
#include "solve/multigrid/smoother.hpp"
#include "solve/rows/matrix.hpp"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace treacle::solve {

// Origin of the matrices below the first.
enum class CoarseMatrices {
    galerkin, // P^T A P over cells: nothing to tune but the over-correction
    grids,    // finite differences on the finest cells, with lambda (dissertation 3.5)
};

// Settings of a Multilevel. std::logic_error from its constructor where they are out of range.
struct MultilevelOptions {
    CoarseMatrices coarse = CoarseMatrices::galerkin; // grids: v only
    Smoother smoother = default_smoother();           // jacobi: of the rows themselves, coarse levels use gauss_seidel
    double jacobi_weight = 2.0 / 3;                   // at most 1
    double overcorrection = 1.6;                      // galerkin: coarse matrices are divided by it, from 1 to below 2
    Cycle cycle = Cycle::w;                           // v where coarse matrices are grids
    int coarse_sweeps = 1;                            // or polynomials, each way on coarse levels
    double relaxation = 1;                            // of Gauss-Seidel sweeps, on all levels; from 1 to below 2
    bool interface_sweeps = false; // rows beside other ranks once more between these sweeps, on all levels
    double grid_coupling = 1;      // grids: n / (lambda H^2), n the rows of a full cell of width H [1/m2]
    int max_coarse_size = 200;     // most unknowns that are solved for directly
    int min_rows_per_rank = 500;   // levels with fewer on average are gathered onto every eighth rank
};

// Cells by which rows are put together. Cells are integer coordinates from -2^20 to 2^20 - 1.
struct MultilevelCells {
    std::span<const int> cells; // [rows][3]
    // For grids:
    std::span<const int> dirichlet; // [n][3], cells with p = 0: this rank's, and those beside its own
    std::span<const double> walls;  // [rows], what walls add to the diagonal
    std::span<const double>
        densities{}; // [rows], of the rows' liquids over that of grid_coupling; empty on all ranks: 1
    // Galerkin products only: [rows], 1 where z stays 0, as if the matrix did not have the row; or empty.
    std::span<const unsigned char> fixed{};
};

// One level of the hierarchy, as a report.
struct LevelSize {
    std::int64_t rows = 0, entries = 0; // over all ranks
    int ranks = 0;                      // that hold rows
};

// A multilevel preconditioner of a matrix whose rows have positions: piecewise constant on cells, then on cells of 2 x
// 2 x 2 cells, and so on; one cycle, symmetric and positive definite (src/solve/theory.md). Aggregates do not cross ranks;
// small levels move to fewer ranks, the last one is solved directly on rank 0.
class Multilevel {
public:
    Multilevel(const Comm& comm, MultilevelOptions options);
    ~Multilevel();
    Multilevel(Multilevel&&) noexcept;
    Multilevel& operator=(Multilevel&&) noexcept;

    // Collective. Memory is kept from one matrix to the next. The matrix must outlive its use in apply.
    void set_up(Matrix& matrix, const MultilevelCells& cells);
    // (ML4) z = M r, collective.
    void apply(std::span<const double> r, std::span<double> z);

    // Collective. The first one is the matrix itself.
    std::vector<LevelSize> sizes() const;
    // Stored entries of all levels over those of the matrix. Collective.
    double operator_complexity() const;
    // Memory of this rank [bytes].
    std::size_t bytes() const;

    // As given to the constructor, checked.
    const MultilevelOptions& options() const { return options_; }

private:
    struct State;
    Comm comm_;
    MultilevelOptions options_;
    std::unique_ptr<State> state_;
};

} // namespace treacle::solve
