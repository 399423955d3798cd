#pragma once
#include "app/study/sweep.hpp"
#include "mpi/comm.hpp"

namespace treacle::app {

// `mpiexec -n N treacle sweep`: the ranks split into groups of runs.ranks, each of which does one run after the other.
// Rank 0 holds the journal and sends runs to the other groups between the steps of its own run, so that no rank is set
// aside. A run that throws fails alone; a run that hangs, or a rank that is killed, ends the job, and the journal has
// what was done. Collective; exit codes as those of sweep_study. Throws InputError.
ExitCode sweep_on_groups(const Comm& comm, const SweepRequest& request);

} // namespace treacle::app
