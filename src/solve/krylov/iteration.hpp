#pragma once
// Inside src/solve only: what one solve is about, and how it ends.
#include "solve/krylov/preconditioner.hpp"

#include <algorithm>
#include <string>

namespace treacle::solve {

// Arguments of one solve and its state. All spans are this rank's rows.
struct Iteration {
    const Comm& comm;
    Matrix& matrix;
    const KrylovOptions& options;
    const ConvergenceTest& test;
    BuiltPreconditioner& preconditioner;
    std::span<const double> b; // [rows] right-hand side
    std::span<double> x;       // [rows] in: the guess, out: the last iterate
    SolveReport report{};      // returned to the caller
    double norm_b = 0;         // ||b|| over all ranks, less its mean with a null space; set by begin()
    // Norm of the residual below which it counts as zero: products of smaller numbers may underflow to the zero that a
    // breakdown is detected by.
    double least = 1e-140;

    // Always true, for `return end(...)`: the iteration is over.
    bool end(Outcome outcome) {
        report.outcome = outcome;
        return true;
    }
    // to = A from, counted in the report; collective.
    void multiply(std::span<const double> from, std::span<double> to) {
        matrix.multiply(from, to);
        ++report.products;
    }
    // The two parts of the test.
    bool passes(double residual_norm, double measured) const {
        return residual_norm <= std::max({test.relative * norm_b, test.absolute, least}) &&
               (!test.local || measured < test.threshold);
    }
    double measure(std::span<const double> r) const { return test.local ? test.local(r) : 0.0; }
};

// SolveReport::reason.
std::string sentence(Outcome outcome, const KrylovOptions& options);

} // namespace treacle::solve
