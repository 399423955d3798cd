#pragma once
#include <string>
#include <vector>

namespace treacle::solve {

// Initialises PETSc for the life of this object: one per program, after MPI and Kokkos, destroyed before
// them. From then on PETSc never prints an error nor ends the program: a failure inside it is thrown as
// SimulationError, as Error with ExitCode::out_of_memory, or as InputError where a PETSc option is at fault.
// PETSc's signal handler stays off and no .petscrc file is read; the variable PETSC_OPTIONS is.
class SolveRuntime {
public:
    // Collective over all ranks. options: "-pressure_pc_type sor -log_view", words separated by blanks.
    // InputError when a word stands where an option is expected.
    explicit SolveRuntime(const std::string& options = "");
    ~SolveRuntime();
    SolveRuntime(const SolveRuntime&) = delete;
    SolveRuntime& operator=(const SolveRuntime&) = delete;

    // Options given to PETSc that nothing has read up to now: misspelt ones, or of a solver not in use.
    std::vector<std::string> unused_options() const;

private:
    std::vector<std::string> words_;
    std::vector<char*> arguments_;
};

// "3.18.5" and "2.26.0", for the manifest.
std::string petsc_version();
std::string hypre_version();

} // namespace treacle::solve
