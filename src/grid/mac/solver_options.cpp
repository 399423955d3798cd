#include "grid/mac/solver_options.hpp"

#include "base/options/options.hpp"

namespace treacle::grid {

const std::vector<std::pair<std::string, Preconditioner>> preconditioners{{"multilevel", Preconditioner::multilevel},
    {"boomeramg", Preconditioner::boomeramg}, {"gamg", Preconditioner::gamg},
    {"incomplete_cholesky", Preconditioner::incomplete_cholesky}, {"jacobi", Preconditioner::jacobi}};

void declare_residual(Declaration& d, double& residual, const std::string& text) {
    d.number("residual", residual, unit::none,
        range_between(1e-14, 0.1).because("rounding alone leaves about 1e-15", "1e-10 is very accurate already"), text);
}

void declare_solve(Declaration& d, Preconditioner& preconditioner, double& residual, int& max_iterations) {
    d.choice("preconditioner", preconditioner, preconditioners,
        "Of the conjugate gradients: the hierarchy of cells of this code; or, to compare with, HYPRE's or PETSc's "
        "algebraic multigrid, incomplete Cholesky of each rank's rows, or the diagonal.");
    declare_residual(d, residual, "Relative residual at which the solve ends.");
    d.integer(
        "max_iterations", max_iterations, range_between(1, 1000000), "Iterations after which the solve has failed.");
}

} // namespace treacle::grid
