#!/usr/bin/env python3
"""A run stops on request with a checkpoint, and goes on from it to the end of the straight run.

usage: stop_test.py PROGRAM MPIEXEC RANKS
"""
import os
import signal
import subprocess
import sys
import time

import harness
from harness import SCENES, TIGHT, Workplace, command_line, overrides

DAM = os.path.join(SCENES, "dam.yaml")
RANKS = 1
SAME_RANKS = 1e-12  # as in resume_test.py
# A run of 200 steps takes a second or more: time to ask it to stop. Frames every 10 steps tell that it is under way.
LONG = {**TIGHT, "time.end": "0.2", "time.step": "0.001", "output.interval": "0.01",
        "output.checkpoint_interval": "0", "lost_limit": "0.1"}


class Stop(Workplace):
    straight = None  # the last frame of the run that nobody stops

    def setUp(self):
        super().setUp()
        if Stop.straight is None:
            self.run_scene(DAM, "straight", RANKS, LONG)
            Stop.straight = self.frame("straight")

    def start(self):
        arguments = ["run", DAM, "--out", "run", *overrides(LONG)]
        return subprocess.Popen(command_line(arguments, RANKS), cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True)

    def wait_for_the_first_frames(self, process):
        end = time.monotonic() + 60
        while time.monotonic() < end and process.poll() is None:
            folder = self.path("run", "frames")
            if os.path.isdir(folder) and len([n for n in os.listdir(folder) if n.startswith("frame_0")]) >= 3:
                return
            time.sleep(0.02)
        self.fail("the run did not get under way: " + process.communicate(timeout=60)[0])

    def expect_stopped(self, process, words):
        out = process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, 5, out)
        self.assertIn(words, out)
        self.assertEqual(len(self.checkpoints("run")), 1)
        self.expect_to_go_on()

    def expect_to_go_on(self):
        before = len(self.steps("run"))
        self.assertLess(before, 200)
        self.treacle("resume", "run", ranks=RANKS)
        self.assertEqual(list(self.steps("run")["step"]), list(range(1, 201)))
        self.assertLessEqual(self.largest_move(self.straight, self.frame("run")), SAME_RANKS)

    def test_by_a_signal(self):
        process = self.start()
        self.wait_for_the_first_frames(process)
        process.send_signal(signal.SIGUSR1)
        self.expect_stopped(process, "a signal")

    def test_by_a_file(self):
        process = self.start()
        self.wait_for_the_first_frames(process)
        open(self.path("run", "STOP"), "w").close()
        self.expect_stopped(process, "STOP")

    def test_by_the_time_limit(self):
        done = self.run_scene(DAM, "run", RANKS, LONG, code=5, extra=["--wall-limit", "0.1 s"])
        self.assertIn("time limit", done.stdout)
        self.expect_to_go_on()


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    RANKS = int(sys.argv.pop(3))
    harness.main(sys.argv, __doc__)
