#!/usr/bin/env bash
# Runs a study as a job array: a task a run. Under Slurm or PBS; only what has no result is run.
#
#   treacle sweep STUDY --ask 40 --to DIR            # DIR/0001 ... DIR/0040; prints their numbers
#   sbatch --array=1-40 --ntasks=4 jobs/array.sh DIR
#   qsub -J 1-40 -l select=1:ncpus=4:mpiprocs=4 -v DIR=folder jobs/array.sh
#   treacle sweep STUDY --tell DIR                   # at any time: the table of what is there
#
# After failures: `treacle sweep STUDY --ask 40 --to DIR --retry failed` prints the numbers that are left, "2,17,30": hand in
# --array=2,17,30. A task that is requeued starts its run again; one that is done ends at once.
# TREACLE names the program (default build/release/treacle of the folder that the job is handed in from).
#SBATCH --job-name=treacle
#SBATCH --ntasks=1
#SBATCH --cpus-per-task=1
#SBATCH --time=04:00:00
#SBATCH --requeue
#PBS -N treacle
#PBS -l walltime=04:00:00
#PBS -j oe
set -euo pipefail

cd "${SLURM_SUBMIT_DIR:-${PBS_O_WORKDIR:-.}}"
folder=${1:-${DIR:?needs the folder of --to}}
treacle=${TREACLE:-build/release/treacle}
export OMP_NUM_THREADS=${OMP_NUM_THREADS:-1}

if [ -n "${SLURM_ARRAY_TASK_ID:-}" ] && [ "${SLURM_NTASKS:-1}" -gt 1 ]; then
    exec srun --ntasks="$SLURM_NTASKS" "$treacle" forward "$folder" --array-task
elif [ -n "${PBS_NODEFILE:-}" ] && [ "$(wc -l <"$PBS_NODEFILE")" -gt 1 ]; then
    exec mpiexec -n "$(wc -l <"$PBS_NODEFILE")" "$treacle" forward "$folder" --array-task
fi
exec "$treacle" forward "$folder" --array-task
