#!/usr/bin/env python3
"""One run at a time writes into a folder; killed at any moment, a run goes on, and each row of its tables stands once.

usage: kill_test.py PROGRAM MPIEXEC
"""
import os
import random
import sys
import time

import harness
from harness import SCENES, TIGHT, Workplace, kill_all, overrides

DAM = os.path.join(SCENES, "dam.yaml")
KILLS = int(os.environ.get("TREACLE_KILLS", 3))
STEPS = 40 * KILLS
CHECKPOINT = 10  # steps between two
LONG = {**TIGHT, "time.end": f"{0.001 * STEPS}", "time.step": "0.001", "output.interval": "0.02", "output.checkpoint_interval": "0.01",
        "output.checkpoints_kept": "2", "max_lost_fraction": "0.1"}
# Particles that collide part on other numbers of ranks (resume_test.py); the liquid as a whole does not.
SAME_MEAN = 0.02 * 0.02  # [m]


class Folder(Workplace):
    def test_a_second_run_is_refused_while_the_first_goes_on(self):
        endless = {**LONG, "time.end": "100"}  # until it is stopped
        first = self.start("run", DAM, "--out", "run", *overrides(endless), ranks=2)
        self.wait_for_frames(first, "run")
        for command in [["run", DAM, "--out", "run", "--overwrite"], ["resume", "run"]]:
            for ranks in [1, 2]:
                done = self.treacle(*command, ranks=ranks, code=2)
                self.assertIn("a run is writing into this folder", done.stderr)
        self.assertIsNone(first.poll(), "the first run was over before the others")
        self.treacle("info", "run")
        open(self.path("run", "STOP"), "w").close()
        out = first.communicate(timeout=120)[0]
        self.assertEqual(first.returncode, 5, out)
        steps = list(self.steps("run")["step"])
        self.assertEqual(steps, list(range(1, len(steps) + 1)))
        self.assertFalse(os.path.exists(self.path("run", "run.lock")))


class Kill(Workplace):
    def setUp(self):
        super().setUp()
        self.random = random.Random(27)
        self.kills = 0

    def sitting(self):
        """Runs or goes on, and kills all ranks at some moment; whether the run ended before that."""
        command = ["resume", "run"] if self.saved() else ["run", DAM, "--out", "run", "--overwrite", *overrides(LONG)]
        process = self.start(*command, ranks=self.random.choice([1, 2, 3]))
        if self.kills == KILLS:
            self.assertEqual(process.wait(timeout=400), 0)
            return True
        self.wait_for_checkpoints(process, self.random.randrange(4))
        if process.poll() is not None:
            self.assertEqual(process.returncode, 0, process.communicate()[0])
            return True
        kill_all(process)
        self.kills += 1
        return False

    def saved(self):
        folder = self.path("run", "checkpoints")
        names = os.listdir(folder) if os.path.isdir(folder) else []
        return max((int(name[11:20]) for name in names if name.endswith(".h5")), default=0)

    def wait_for_checkpoints(self, process, count):
        """Until the session has written so many, and for a part of the time that they took."""
        begun, first = time.monotonic(), self.saved()
        while process.poll() is None and self.saved() < first + CHECKPOINT * count:
            time.sleep(0.002)
        time.sleep(self.random.uniform(0, (time.monotonic() - begun) / max(1, count)))

    def test_each_row_stands_once(self):
        while not self.sitting():
            pass
        self.assertEqual(self.kills, KILLS, "the run was over before the others")
        self.run_scene(DAM, "straight", 1, LONG)
        for table in ["steps.csv", "bodies.csv", "measurements.csv"]:
            one, other = self.columns("straight", table), self.columns("run", table)
            self.assertEqual(one.dtype.names, other.dtype.names)
            self.assertEqual(list(one["step"]), list(other["step"]), table)
        self.assertEqual(list(self.steps("run")["step"]), list(range(1, STEPS + 1)))
        one, other = self.frame("straight"), self.frame("run")
        self.assertEqual(one["time"], other["time"])
        self.assertLess(abs(one["position"].mean(0) - other["position"].mean(0)).max(), SAME_MEAN)
        print(f"{self.kills} kills, {STEPS} rows once in each table")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
