#!/bin/sh
# An evaluation of Dakota's: driver.sh PARAMETERS RESULTS. Always ends with 0: a run that failed is told by FAIL in the
# results file, which Dakota's failure_capture looks for.
#
# STUDY    the study's file
# TREACLE  the program (default build/release/treacle of the folder that Dakota is started in)
# RANKS    of each run (default 1: without mpiexec); runs.ranks of the study
launcher=
[ "${RANKS:-1}" -gt 1 ] && launcher="mpiexec -n $RANKS"
$launcher "${TREACLE:-build/release/treacle}" forward --study "${STUDY:?names the study}" --params "$1" --results "$2" >"$2.log" 2>&1
exit 0
