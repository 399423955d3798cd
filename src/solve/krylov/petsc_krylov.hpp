#pragma once
// Inside src/solve only: PETSc's own Krylov methods, chosen by PETSc's options.
#include "solve/krylov/iteration.hpp"

#include <string>

namespace treacle::solve {

// True when the options database has one for a Krylov method of this prefix, as -pressure_ksp_type.
bool asks_for_petsc(const std::string& prefix);

// Solves A x = b from the guess in x by PETSc's conjugate gradients or the method of the options, with the
// preconditioner that is set up. The test of the run ends it, or -PREFIX_ksp_rtol (of ||b||), -PREFIX_ksp_atol, where
// they are given. Collective. Throws what PETSc throws.
void iterate_with_petsc(Iteration& run, const std::string& prefix);

} // namespace treacle::solve
