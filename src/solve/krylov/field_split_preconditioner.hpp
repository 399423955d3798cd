#pragma once
#include "solve/krylov/krylov.hpp"
#include "solve/rows/block_rows.hpp"

#include <deque>

namespace treacle::solve {

// A preconditioner of systems of several components, one of PETSc's or HYPRE's for each of them by itself: the couplings of
// different components are left out, and algebraic multigrid gets scalar matrices.
class FieldSplitPreconditioner {
public:
    FieldSplitPreconditioner(const Comm& comm, std::string prefix, Preconditioner preconditioner);

    // Collective. `components` [rows], 0 … count - 1. SimulationError when one cannot be made.
    void set_up(const Matrix& matrix, std::span<const signed char> components, int count);
    // z = M r, collective.
    void apply(std::span<const double> r, std::span<double> z);
    std::size_t bytes() const;

private:
    struct Part {
        std::vector<Index> rows; // of the whole matrix
        BlockMatrix matrix;
        std::unique_ptr<KrylovSolver> solver;
        std::vector<double> r, z;
    };
    BlockRows take_rows(const Matrix& matrix, std::span<const signed char> components, int component, Part& part);

    Comm comm_;
    std::string prefix_;
    KrylovOptions options_;
    std::deque<Part> parts_;
    std::vector<double> numbers_;
};

} // namespace treacle::solve
