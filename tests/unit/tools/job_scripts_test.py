"""The job scripts stop a run before the time limit and go on in another job, with stand-ins for the queue."""

import os
import pathlib
import signal
import subprocess
import tempfile
import time
import unittest

ROOT = pathlib.Path(__file__).resolve().parents[3]

# Ends with exit code 5 and a checkpoint on SIGUSR1, as the program does; on "resume" it ends well.
TREACLE = """#!/usr/bin/env bash
echo "$@" >> calls
[ "$1" = resume ] && exit 0
folder=$4
[ -n "${CODE:-}" ] && exit "$CODE"
stop() { sleep 0.05; mkdir -p "$folder/checkpoints"; touch "$folder/checkpoints/1"; exit 5; }
trap stop USR1
touch running
for i in $(seq 400); do sleep 0.05; done
"""
LAUNCHER = """#!/usr/bin/env bash
while [ "${1#-}" != "$1" ]; do [ "$1" = -n ] && shift; shift; done
exec "$@"
"""
QUEUE = """#!/usr/bin/env bash
echo "$@" >> submitted
"""


class JobScripts(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        for name, text in {"treacle": TREACLE, "srun": LAUNCHER, "mpiexec": LAUNCHER, "scontrol": QUEUE,
                           "qsub": QUEUE}.items():
            path = self.folder / name
            path.write_text(text)
            path.chmod(0o755)
        (self.folder / "nodes").write_text("a\na\nb\n")

    def start(self, script, *arguments, **variables):
        environment = {**os.environ, "PATH": f"{self.folder}:{os.environ['PATH']}", "TREACLE": "./treacle",
                       "SLURM_NTASKS": "3", "SLURM_JOB_ID": "7", "PBS_NODEFILE": "nodes", **variables}
        for name in ("SLURM_SUBMIT_DIR", "PBS_O_WORKDIR"):
            environment[name] = str(self.folder)
        return subprocess.Popen([ROOT / "jobs" / script, *arguments], cwd=self.folder, env=environment,
                                stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def lines(self, name):
        path = self.folder / name
        return path.read_text().splitlines() if path.exists() else []

    def wait_for(self, name):
        for _ in range(400):
            if (self.folder / name).exists():
                return
            time.sleep(0.05)
        self.fail(f"{name} did not appear")

    def test_slurm_stops_on_the_signal_and_goes_back_to_the_queue(self):
        job = self.start("slurm.sh", "scene.yaml", "results", "--set", "a=1")
        self.wait_for("running")
        job.send_signal(signal.SIGUSR1)
        self.assertEqual(0, job.wait(timeout=20))
        self.assertEqual(["requeue 7"], self.lines("submitted"))

    def test_pbs_stops_before_the_limit_and_submits_the_rest(self):
        job = self.start("pbs.sh", SCENE="scene.yaml", FOLDER="results", LIMIT="2", MARGIN="1")
        self.assertEqual(0, job.wait(timeout=20))
        self.assertEqual(1, len(self.lines("submitted")))

    def test_a_folder_with_checkpoints_is_resumed(self):
        (self.folder / "results/checkpoints").mkdir(parents=True)
        self.assertEqual(0, self.start("slurm.sh", "scene.yaml", "results").wait(timeout=20))
        self.assertEqual(0, self.start("pbs.sh", SCENE="scene.yaml", FOLDER="results").wait(timeout=20))
        self.assertEqual(["resume results"] * 2, self.lines("calls"))
        self.assertEqual([], self.lines("submitted"))

    def test_a_failed_run_keeps_its_exit_code_and_submits_nothing(self):
        self.assertEqual(3, self.start("slurm.sh", "scene.yaml", "results", CODE="3").wait(timeout=20))
        self.assertEqual(3, self.start("pbs.sh", SCENE="s", FOLDER="results", CODE="3").wait(timeout=20))
        self.assertEqual([], self.lines("submitted"))

    def test_a_run_that_got_no_further_is_not_submitted_again(self):
        (self.folder / "results").mkdir()
        self.assertEqual(5, self.start("slurm.sh", "scene.yaml", "results", CODE="5").wait(timeout=20))
        self.assertEqual([], self.lines("submitted"))


if __name__ == "__main__":
    unittest.main()
