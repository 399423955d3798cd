#!/usr/bin/env bash
# Runs a study on all nodes of one job of Slurm: a step a run, and the next as soon as one ends. Handed in again, it goes on.
#
#   sbatch --nodes=4 --ntasks-per-node=64 jobs/study.sh STUDY [RANKS] [ARGUMENT OF treacle sweep ...]
#
# RANKS     of each run (default 1); the job's tasks divided by it are the lanes
# TREACLE   names the program (default build/release/treacle of the folder that sbatch is called in)
# MEMORY    of a run's rank (default: the job's memory by its CPUs)
# --exact and --mem-per-cpu: without them the first step takes all memory of its node, and the others wait. More than some 500
# steps at once need `sbatch --stepmgr` (Slurm 24.05).
#SBATCH --job-name=treacle-study
#SBATCH --cpus-per-task=1
#SBATCH --time=12:00:00
#SBATCH --signal=B:TERM@300
#SBATCH --open-mode=append
#SBATCH --requeue
set -euo pipefail

if [ $# -lt 1 ]; then
    echo "usage: sbatch jobs/study.sh STUDY [RANKS] [ARGUMENT OF treacle sweep ...]" >&2
    exit 2
fi
study=$1
ranks=${2:-1}
shift $(($# < 2 ? $# : 2))

cd "${SLURM_SUBMIT_DIR:-.}"
treacle=${TREACLE:-build/release/treacle}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}
memory=${MEMORY:-${SLURM_MEM_PER_CPU:-$((${SLURM_MEM_PER_NODE:-1000} / ${SLURM_CPUS_ON_NODE:-1}))}}

"$treacle" sweep "$study" --set "runs.ranks=$ranks" --set "runs.lanes=$((SLURM_NTASKS / ranks))" \
    --set "runs.launcher=srun --exact --ntasks={ranks} --mem-per-cpu=$memory" "$@" &
sweep=$!
trap 'kill -TERM "$sweep"' TERM
code=0
wait "$sweep" || code=$?
if [ "$code" -gt 128 ]; then # the signal ended the waiting, not the sweep
    code=0
    wait "$sweep" || code=$?
fi
# Stopped shortly before the time limit: goes on in the next job.
if [ "$code" -eq 5 ]; then
    scontrol requeue "$SLURM_JOB_ID"
    code=0
fi
exit "$code"
