# Environment of Treacle's own runs; sourced by the tools, never run. Only what is unset gets a value.
# shellcheck shell=bash

set_default() {
    if [ -z "${!1:-}" ]; then
        export "$1=$2"
    fi
}

# Open MPI in a container or on a laptop: root, more ranks than cores, several small jobs side by side.
# Other MPI implementations ignore these.
set_default OMPI_ALLOW_RUN_AS_ROOT 1
set_default OMPI_ALLOW_RUN_AS_ROOT_CONFIRM 1
set_default OMPI_MCA_rmaps_base_oversubscribe 1
set_default OMPI_MCA_hwloc_base_binding_policy none
set_default OMPI_MCA_mpi_yield_when_idle 1
set_default OMPI_MCA_btl_vader_single_copy_mechanism none

# Ranks are the parallelism on processors: no threads beside them.
set_default OMP_NUM_THREADS 1
set_default OMP_PROC_BIND false
set_default OPENBLAS_NUM_THREADS 1

# Cores that this process may use; nproc alone obeys OMP_NUM_THREADS, which is set above.
count_cores() {
    env -u OMP_NUM_THREADS -u OMP_THREAD_LIMIT nproc
}

# Ninja and ccache where they are there; an existing build folder keeps the generator that it has.
if command -v ninja >/dev/null; then
    set_default CMAKE_GENERATOR Ninja
fi
