"""Row of `ensembles` on a real Slurm: arrays, a study in one job, a chain of jobs."""

import shutil

from .repairs_files import driver
from .table import Figure, Unmeasured


def real_slurm(context):
    """A Slurm of one node that the driver starts and stops; its tests compare tables and frames with runs without Slurm."""
    missing = [name for name in ("sbatch", "slurmctld", "slurmd", "munged") if not shutil.which(name, path="/usr/sbin:/usr/bin:/sbin:/bin")]
    if missing:
        raise Unmeasured(f"needs {', '.join(missing)}: apt-get install slurm-wlm munge")
    done, text = driver(context, "slurm_test.py", env={"TREACLE_SLURM_TESTS": "1"})
    if done.code == 77:
        raise Unmeasured(done.output.strip().splitlines()[-2])
    return Figure(text + ": array of 12 with task 5 killed and requeued, a study with a step a run, a chain of three jobs", done.code == 0)


def add_rows(table):
    table.row("real Slurm", claim="array of 12 with one killed and requeued; a study in one job; chain of three jobs",
              asked="tables whole; the chain equals one long run")(real_slurm)
