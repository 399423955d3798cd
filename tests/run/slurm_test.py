#!/usr/bin/env python3
"""Jobs of a real Slurm of one node, which the test starts and stops: arrays, a study in one job, a chain of jobs.

usage: TREACLE_SLURM_TESTS=1 slurm_test.py PROGRAM MPIEXEC; exit code 77 without the variable and where Slurm is not installed
"""
import os
import subprocess
import sys
import tempfile
import time

import harness
from harness import Program
from sweep_test import Study

ROOT = os.path.dirname(os.path.dirname(harness.HERE))
SLURM = os.path.join(ROOT, "tests", "slurm", "slurm")
# The program; task 5 sleeps in its first attempt, to be killed there.
WAITING = """#!/bin/sh
if [ "$SLURM_ARRAY_TASK_ID" = 5 ] && [ "${{SLURM_RESTART_COUNT:-0}}" = 0 ]; then touch {folder}/waits; exec sleep 300; fi
exec {program} "$@"
"""


class Jobs(Study):
    folder_of_slurm = ""

    def setUp(self):
        super().setUp()
        self.env = {**os.environ, "SLURM_CONF": os.path.join(Jobs.folder_of_slurm, "slurm.conf"), "TREACLE": Program.path, "SLURM_MPI_TYPE": "pmix"}

    def run_command(self, *command):
        done = subprocess.run([str(word) for word in command], cwd=self.folder, env=self.env, capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0, f"{command}: {done.stdout}{done.stderr}")
        return done.stdout

    def submit(self, *arguments):
        return self.run_command("sbatch", "--parsable", *arguments).strip()

    def states(self, job):
        return self.run_command("squeue", "--job", job, "--states=all", "--array", "--noheader", "--format=%T").split()

    def start_again_at_once(self, job):
        self.wait(lambda: "PENDING" in self.states(job), job)
        time.sleep(5)  # the node records that it has killed the job, to the second
        self.run_command("scontrol", "update", f"JobId={job}", "StartTime=now")

    def wait(self, condition, job, seconds=200):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                self.fail(f"{self.states(job)} {self.logs()}")
            time.sleep(0.2)

    def logs(self):
        text = ""
        for name in sorted(os.listdir(self.folder)):
            if name.startswith("slurm-"):
                with open(self.path(name)) as file:
                    text += f"{name}: {file.read()}"
        return text

    def ends(self, job, seconds=200):
        self.wait(lambda: not set(self.states(job)) - {"COMPLETED", "FAILED", "CANCELLED", "TIMEOUT"}, job, seconds)
        return set(self.states(job))

    def test_an_array_of_12_with_one_killed_and_requeued(self):
        self.change("points: 4", "points: 6")
        self.sweep(out="good")
        self.sweep("--ask", 12, "--to", "asked")
        self.write_script("waiting.sh", WAITING.format(folder=self.folder, program=Program.path))
        self.env["TREACLE"] = self.path("waiting.sh")
        job = self.submit("--array=1-12", os.path.join(ROOT, "jobs", "array.sh"), "asked")
        self.wait(lambda: os.path.exists(self.path("waits")), job)
        self.run_command("scontrol", "requeue", f"{job}_5")
        self.start_again_at_once(f"{job}_5")
        self.assertEqual(self.ends(job), {"COMPLETED"})
        self.sweep("--tell", "asked")
        self.assertEqual(self.figures(), self.figures("good"))

    def test_a_study_in_one_job_with_a_step_a_run(self):
        self.sweep(out="good")
        job = self.submit("--ntasks=2", os.path.join(ROOT, "jobs", "study.sh"), "study.yaml", "1", "--out", "out")
        self.assertEqual(self.ends(job), {"COMPLETED"})
        self.assertEqual(self.figures(), self.figures("good"))

    def test_a_chain_of_three_jobs_is_one_long_run(self):
        values = ["--set", "time.end=3 s", "--set", "time.step=2 ms", "--set", "output.interval=0.1 s"]
        self.treacle("run", "block.yaml", "--out", "straight", *values)
        job = self.submit("--ntasks=1", os.path.join(ROOT, "jobs", "slurm.sh"), "block.yaml", "chain", *values)
        for _ in range(2):
            begun = self.count("chain")
            self.wait(lambda: self.count("chain") > begun + 5, job)
            self.run_command("scancel", "--signal=USR1", "--batch", job)
            self.start_again_at_once(job)
        self.assertEqual(self.ends(job), {"COMPLETED"})
        self.assertEqual(list(self.steps("chain")["step"]), list(self.steps("straight")["step"]))
        self.assertLess(self.largest_move(self.frame("chain"), self.frame("straight")), 1e-6)

    def count(self, run):
        path = self.path(run, "steps.csv")
        if not os.path.exists(path):
            return 0
        with open(path) as file:
            return len(file.readlines())


def main():
    if not os.environ.get("TREACLE_SLURM_TESTS"):
        print("TREACLE_SLURM_TESTS is not set: nothing is tested")
        sys.exit(77)
    with tempfile.TemporaryDirectory(prefix="treacle_slurm_") as folder:
        started = subprocess.run([SLURM, "start", folder, "2"])
        if started.returncode != 0:
            print("Slurm is not there: nothing is tested")
            sys.exit(77)
        Jobs.folder_of_slurm = folder
        try:
            harness.main(sys.argv, __doc__)
        finally:
            subprocess.run([SLURM, "stop", folder], check=False)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main()
