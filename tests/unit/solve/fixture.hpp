#pragma once
#include "mpi/comm.hpp"
#include "solve/rows/matrix.hpp"
#include "solve/rows/runtime.hpp"

#include <functional>
#include <span>
#include <vector>

namespace treacle::solve {

// The program's one runtime, with the options that runtime_test.cpp checks.
const SolveRuntime& runtime();

// Rows [first, first + rows) of a matrix given entry by entry, in the arrays that a Matrix borrows.
struct TestSystem {
    using Entry = std::pair<Index, double>;
    // Entries of a global row, columns rising.
    using Row = std::function<std::vector<Entry>(Index)>;

    Index first = 0;
    Index rows = 0;
    Index global_rows = 0;
    std::vector<Index> diagonal_offsets{0}, diagonal_columns, off_offsets{0}, off_columns;
    std::vector<double> diagonal_values, off_values;
    RowHalo halo;
    Row row;

    // Rows shared out evenly among the first `owners` ranks; the others have none.
    TestSystem(const Comm& comm, Index global_rows, Row row, int owners = 1 << 20);
    CsrBlocks blocks();
    // A x for x given at every global row, by a plain loop over the definition.
    std::vector<double> product(const std::function<double(Index)>& x) const;
    std::vector<double> values(const std::function<double(Index)>& x) const;
};

// -Laplacian on n^3 cells with spacing 1, 7 points; zero values around it, or closed (zero slope, singular).
enum class Border { dirichlet, closed };
TestSystem poisson(const Comm& comm, Index n, Border border, int owners = 1 << 20);

// A number in [-1, 1) that depends on the row alone.
double noise(Index row);

// sqrt of the sum of squares over all ranks of a - b.
double distance(const Comm& comm, const std::vector<double>& a, const std::vector<double>& b);

// That z = M r, by apply(r, z), is symmetric and positive for two vectors of this rank's rows.
void expect_symmetric_and_positive(const Comm& comm, const TestSystem& system,
    const std::function<void(std::span<const double>, std::span<double>)>& apply);

} // namespace treacle::solve
