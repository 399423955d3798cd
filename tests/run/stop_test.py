#!/usr/bin/env python3
"""A run stops on request with a checkpoint, and goes on from it to the end of the straight run.

usage: stop_test.py PROGRAM MPIEXEC RANKS
"""
import json
import os
import signal
import sys
import unittest

import harness
from harness import SCENES, TIGHT, Workplace, overrides, ranks_of

DAM = os.path.join(SCENES, "dam.yaml")
RANKS = 1
SAME_RANKS = 1e-12  # as in resume_test.py
# A run of 200 steps takes a second or more: time to stop it. Frames every 10 steps show that it is under way.
LONG = {**TIGHT, "time.end": "0.2", "time.step": "0.001", "output.interval": "0.01",
        "output.checkpoint_interval": "0", "max_lost_fraction": "0.1"}


class Stop(Workplace):
    straight = None  # the last frame of the run without a stop

    def setUp(self):
        super().setUp()
        if Stop.straight is None:
            self.run_scene(DAM, "straight", RANKS, LONG)
            Stop.straight = self.frame("straight")

    def under_way(self, **options):
        process = self.start("run", DAM, "--out", "run", *overrides(LONG), ranks=RANKS, **options)
        self.wait_for_frames(process, "run")
        return process

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
        process = self.under_way()
        process.send_signal(signal.SIGUSR1)
        self.expect_stopped(process, "a signal")

    def test_by_a_lost_connection(self):
        process = self.under_way()
        for pid in ranks_of(process):
            os.kill(pid, signal.SIGHUP)
        self.expect_stopped(process, "a signal")

    @unittest.skipIf(len(sys.argv) > 3 and sys.argv[3] != "1", "what mpiexec ignores its ranks do not")
    def test_a_lost_connection_does_not_stop_what_ignores_it(self):
        process = self.under_way(preexec_fn=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
        for pid in ranks_of(process):
            os.kill(pid, signal.SIGHUP)
        out = process.communicate(timeout=120)[0]
        self.assertEqual(process.returncode, 0, out)

    @unittest.skipIf(len(sys.argv) > 3 and sys.argv[3] != "1", "mpiexec itself breaks down without its output")
    def test_lost_output_does_not_stop_it(self):
        process = self.under_way()
        process.stdout.close()
        self.assertEqual(process.wait(timeout=120), 0)
        self.assertEqual(list(self.steps("run")["step"]), list(range(1, 201)))
        with open(self.path("run", "summary.json")) as file:
            self.assertEqual(json.load(file)["ended"], "finished")

    def test_by_a_file(self):
        process = self.under_way()
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
