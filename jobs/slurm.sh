#!/usr/bin/env bash
# Runs a scene under Slurm for as many jobs as it takes: ten minutes before the time limit the run writes a
# checkpoint and ends with exit code 5, and the job goes back to the queue to resume.
#
#   sbatch --ntasks=256 --time=12:00:00 jobs/slurm.sh SCENE FOLDER [ARGUMENT OF treacle run ...]
#
# TREACLE names the program (default build/release/treacle of the folder that sbatch is called in).
#SBATCH --job-name=treacle
#SBATCH --ntasks=64
#SBATCH --cpus-per-task=1
#SBATCH --time=04:00:00
#SBATCH --signal=B:USR1@600
#SBATCH --open-mode=append
#SBATCH --requeue
set -euo pipefail

if [ $# -lt 2 ]; then
    echo "usage: sbatch jobs/slurm.sh SCENE FOLDER [ARGUMENT OF treacle run ...]" >&2
    exit 2
fi
scene=$1
folder=$2
shift 2

cd "${SLURM_SUBMIT_DIR:-.}"
treacle=${TREACLE:-build/release/treacle}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}

if [ -e "$folder/checkpoints" ]; then
    command=("$treacle" resume "$folder")
else
    command=("$treacle" run "$scene" --out "$folder" "$@")
fi

started=$(mktemp)
srun --ntasks="$SLURM_NTASKS" "${command[@]}" &
run=$!
# A signal ends wait before the run has ended: wait again for the run's own exit code.
signalled=no
trap 'signalled=yes; kill -USR1 "$run"' USR1
while :; do
    signalled=no
    code=0
    wait "$run" || code=$?
    [ "$signalled" = yes ] || break
done
trap - USR1

# Resuming is worth another job only where this one got further. A requeued job keeps all that sbatch was given.
if [ "$code" -eq 5 ] && [ -n "$(find "$folder/checkpoints" -newer "$started" -print -quit)" ]; then
    scontrol requeue "$SLURM_JOB_ID"
    code=0
fi
rm -f "$started"
exit "$code"
