#pragma once
// Inside src/solve only: what one solve is about, and how it ends.
#include "solve/krylov/preconditioner.hpp"

#include <algorithm>
#include <string>

namespace treacle::solve {

struct Iteration {
    const Comm& comm;
    Matrix& matrix;
    const KrylovOptions& options;
    const ConvergenceTest& test;
    BuiltPreconditioner& preconditioner;
    std::span<const double> b;
    std::span<double> x;
    SolveReport report{};
    double norm_b = 0;
    // Norm of the residual below which it counts as zero: products of smaller numbers may underflow to the zero that a
    // breakdown is detected by.
    double least = 1e-140;

    bool end(Outcome outcome) {
        report.outcome = outcome;
        return true;
    }
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
