#pragma once
// Inside tests/unit/solve only: systems of rows in cells, and variants of the multilevel preconditioner that solves them.
#include "fixture.hpp"
#include "solve/krylov/krylov.hpp"
#include "solve/multigrid/multilevel.hpp"

#include <array>
#include <gtest/gtest.h>
#include <string>
#include <utility>

namespace treacle::solve::multilevel_test {

using Cell = std::array<int, 3>;

// A system, the cells of its rows, and a solver with the multilevel preconditioner.
struct Sample {
    Comm comm;
    TestSystem system;
    std::vector<int> cells, dirichlet;
    std::vector<double> walls, densities;
    std::vector<unsigned char> fixed;
    Multilevel multilevel;
    int set_ups = 0;

    Sample(const Comm& group, TestSystem given, const std::function<Cell(Index)>& cell_of,
        const MultilevelOptions& options)
        : comm(group), system(std::move(given)), multilevel(group, options) {
        for (Index i = system.first; i < system.first + system.rows; ++i) {
            const auto cell = cell_of(i);
            cells.insert(cells.end(), cell.begin(), cell.end());
        }
        walls.assign(static_cast<std::size_t>(system.rows), 0.0);
    }
    Matrix matrix() { return Matrix(comm, system.blocks()); }
    KrylovOptions krylov() {
        KrylovOptions options;
        options.user.apply = [this](std::span<const double> r, std::span<double> z) { multilevel.apply(r, z); };
        options.user.set_up = [this](Matrix& matrix) {
            ++set_ups;
            multilevel.set_up(matrix, {cells, dirichlet, walls, densities, fixed});
        };
        return options;
    }
    // Solves for the right-hand side of a known solution and checks the residual.
    int iterations(double residual) {
        auto a = matrix();
        KrylovSolver solver(comm, "test", krylov());
        const auto b = system.product(noise);
        std::vector<double> x(b.size(), 0.0);
        const auto report = solver.solve(a, b, x, ConvergenceTest::residual(residual));
        EXPECT_TRUE(report.converged()) << report.reason;
        EXPECT_LE(report.relative_residual, 1.01 * residual);
        return report.iterations;
    }
};

// Cells of 2 x 2 x 2 rows.
inline Cell pair_cell(Index n, Index i) { return {int(i % n) / 2, int(i / n % n) / 2, int(i / (n * n)) / 2}; }

struct Variant {
    std::string name;
    MultilevelOptions options;
};

inline Variant variant(const std::string& name) {
    Variant out{name, {}};
    auto& options = out.options;
    options.max_coarse_size = 30; // several levels even on small systems
    options.min_rows_per_rank = 100;
    if (name == "relaxed" || name == "relaxed_interface_sweeps") options.relaxation = 1.2;
    options.interface_sweeps = name == "relaxed_interface_sweeps";
    if (options.relaxation > 1) options.smoother = Smoother::gauss_seidel;
    if (name == "jacobi") options.smoother = Smoother::jacobi;
    if (name == "chebyshev") options.smoother = Smoother::chebyshev;
    if (name == "sweeps") options.smoother = Smoother::gauss_seidel;
    if (name == "v_cycle") options.cycle = Cycle::v;
    if (name == "v_cycle_two_sweeps") {
        options.cycle = Cycle::v;
        options.coarse_sweeps = 2;
    }
    if (name == "grids") {
        options.coarse = CoarseMatrices::grids;
        options.smoother = Smoother::jacobi;
        options.cycle = Cycle::v;
        options.grid_coupling = 8 / (2.0 * 2.0); // eight rows a cell of width 2
    }
    return out;
}

inline Sample poisson_sample(const Comm& comm, Index n, Border border, const Variant& chosen, int owners = 1 << 20) {
    Sample sample(
        comm, poisson(comm, n, border, owners), [n](Index i) { return pair_cell(n, i); }, chosen.options);
    const int m = static_cast<int>((n + 1) / 2);
    for (int z = -1; z <= m; ++z) {
        for (int y = -1; y <= m; ++y) {
            for (int x = -1; x <= m; ++x) {
                const auto outside = [m](int c) { return c < 0 || c == m; };
                if (border == Border::dirichlet && (outside(x) || outside(y) || outside(z))) {
                    sample.dirichlet.insert(sample.dirichlet.end(), {x, y, z});
                }
            }
        }
    }
    return sample;
}

} // namespace treacle::solve::multilevel_test
