#!/usr/bin/env bash
# Runs a scene under PBS for as many jobs as it takes: ten minutes before LIMIT the run writes a checkpoint
# and ends with exit code 5, and the job hands itself in again to resume.
#
#   qsub -l select=4:ncpus=64:mpiprocs=64 -l walltime=12:00:00 \
#        -v SCENE=inputs/dam_break/scene.yaml,FOLDER=/scratch/dam,LIMIT=43200 jobs/pbs.sh
#
# LIMIT     the walltime in seconds (default 14400): PBS does not tell a job when it will be ended
# TREACLE   the program (default build/release/treacle of the folder that qsub is called in)
# SELECT    what -l select was given, for the next job (default: one chunk of all ranks)
# ARGUMENTS more arguments of treacle run, separated by spaces
#PBS -N treacle
#PBS -l select=1:ncpus=64:mpiprocs=64
#PBS -l walltime=04:00:00
#PBS -j oe
set -euo pipefail

: "${SCENE:?needs -v SCENE=file}" "${FOLDER:?needs -v FOLDER=folder}"
limit=${LIMIT:-14400}
margin=${MARGIN:-600}

cd "${PBS_O_WORKDIR:-.}"
treacle=${TREACLE:-build/release/treacle}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
ranks=$(wc -l <"$PBS_NODEFILE")

if [ -e "$FOLDER/checkpoints" ]; then
    command=("$treacle" resume "$FOLDER")
else
    read -r -a arguments <<<"${ARGUMENTS:-}"
    command=("$treacle" run "$SCENE" --out "$FOLDER" ${arguments[@]+"${arguments[@]}"})
fi

started=$(mktemp)
mpiexec -n "$ranks" "${command[@]}" &
run=$!
(
    sleep $((limit - margin))
    kill -USR1 "$run"
) &
alarm=$!
code=0
wait "$run" || code=$?
kill "$alarm" 2>/dev/null || true

# Resuming is worth another job only where this one got further.
if [ "$code" -eq 5 ] && [ -n "$(find "$FOLDER/checkpoints" -newer "$started" -print -quit)" ]; then
    qsub -l "select=${SELECT:-1:ncpus=$ranks:mpiprocs=$ranks}" -l "walltime=$limit" \
        -v "SCENE=$SCENE,FOLDER=$FOLDER,LIMIT=$limit,MARGIN=$margin,TREACLE=$treacle,ARGUMENTS=${ARGUMENTS:-}" \
        jobs/pbs.sh
    code=0
fi
rm -f "$started"
exit "$code"
