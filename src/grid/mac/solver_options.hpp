#pragma once
#include <string>
#include <utility>
#include <vector>

namespace treacle {
class Declaration;
}

namespace treacle::grid {

// Exchange of momentum between liquid and bodies within a step.
enum class Coupling {
    strong, // bodies' velocities are unknowns beside the liquid's
    weak,   // the liquid takes bodies as they move, and they take its forces afterwards
    one_way // the liquid has no effect on bodies
};
// Preconditioners of the pressure and viscous solves.
enum class Preconditioner { multilevel, boomeramg, gamg, incomplete_cholesky, jacobi };
extern const std::vector<std::pair<std::string, Preconditioner>> preconditioners; // by the words of scenes

// Keys "preconditioner", "residual" and "max_iterations" of a solve.
void declare_solve(Declaration& d, Preconditioner& preconditioner, double& residual, int& max_iterations);
void declare_residual(Declaration& d, double& residual, const std::string& text);

} // namespace treacle::grid
