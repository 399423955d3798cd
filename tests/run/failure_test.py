#!/usr/bin/env python3
"""A simulation that fails ends with exit code 3, prints the reason, and leaves the last checkpoint intact.

usage: failure_test.py PROGRAM MPIEXEC RANKS
"""
import csv
import os
import subprocess
import sys
import unittest

import harness
from harness import Program, SCENES, Workplace

DAM = os.path.join(SCENES, "dam.yaml")
RANKS = 1


class Failure(Workplace):
    def fail_with(self, *words, values=None, out="run", ranks=None):
        done = self.run_scene(DAM, out, RANKS if ranks is None else ranks, values or {}, code=3)
        for word in words:
            self.assertIn(word, done.stderr)
        return done

    def test_too_many_lost_particles_are_counted_and_listed(self):
        # 1 km/s makes 2 m a step: every particle leaves through the wall at once.
        self.fail_with("particles are lost", "640 went through a wall", "max_lost_fraction", "lost_particles.csv",
                       values={"liquids.water.velocity": "[1000, 0, 0]", "max_lost_fraction": "0.5"})
        with open(self.path("run", "lost_particles.csv")) as file:
            rows = list(csv.DictReader(file))
        self.assertEqual(len({row["id"] for row in rows}), 640)
        self.assertTrue(all(float(row["x [m]"]) > 0.4 for row in rows))

    def test_losses_below_the_limit_are_counted_and_the_run_goes_on(self):
        done = self.run_scene(DAM, "run", RANKS, {"liquids.water.velocity": "[1000, 0, 0]", "max_lost_fraction": "1"})
        self.assertIn("lost 640", done.stdout)
        self.assertEqual(self.steps("run")["lost by leak"][-1], 640)

    def test_what_leaves_through_an_open_side_is_lost(self):
        leaving = {"liquids.water.velocity": "[4, 0, 0]", "domain.boundaries.x_max": "open", "max_lost_fraction": "0.1", "time.end": "0.1"}
        for kind in ["sph", "grid"]:
            with self.subTest(kind):
                self.fail_with("particles are lost", "left through an open side", "outflow: true",
                               values={**leaving, "method.kind": kind}, out=kind)
                with open(self.path(kind, "lost_particles.csv")) as file:
                    self.assertEqual({row["cause"] for row in csv.DictReader(file)}, {"4"})

    def test_what_may_leave_or_meets_an_outlet_is_not_lost(self):
        leaving = {"liquids.water.velocity": "[4, 0, 0]", "time.end": "0.1", "max_lost_fraction": "0"}
        # The box ends at the open side: what flies beyond it within a step is the outlet's.
        outlet = {"domain.boundaries.x_max": "open", "outlets": "[{box: {min: [0.39, 0, 0], max: [0.4, 0.16, 0.24]}}]"}
        for kind in ["sph", "grid"]:
            for name, values in [("side", {"domain.boundaries.x_max": "{kind: open, outflow: true}"}), ("outlet", outlet)]:
                with self.subTest(kind=kind, to=name):
                    self.run_scene(DAM, kind + name, RANKS, {**leaving, **values, "method.kind": kind, "bodies": "[]"})
                    self.assertGreater(self.steps(kind + name)["flowed out"][-1], 100)

    @unittest.skipUnless(os.path.isdir("/dev/shm"), "semaphores have no names here")
    def test_semaphores_that_killed_runs_have_left_closed_stop_nobody(self):
        # Open MPI's: 32 bytes, value 0, named after a file.
        left = "/dev/shm/sem.OMPIO_frame_000000.hdf.tmp"
        with open(left, "wb") as file:
            file.write(bytes(32))
        self.run_scene(DAM, "run", RANKS, {"time.end": "0.01"})

    def test_lone_runs_end_without_files_of_others(self):
        # Open MPI gives all processes that start alone one name, and with the first that ends goes the folder of that name.
        os.mkdir(self.path("temporary"))
        alone = {**os.environ, "OMPI_MCA_ess_singleton_isolated": "1", "TMPDIR": self.path("temporary")}
        words = [Program.path, "run", DAM, "--set", "output.interval=2 ms", "--set"]
        longer = subprocess.Popen([*words, "time.end=0.2 s", "--out", self.path("longer")], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, env=alone)
        self.wait_for_frames(longer, "longer")
        done = subprocess.run([*words, "time.end=2 ms", "--out", self.path("shorter")], capture_output=True, text=True, env=alone)
        self.assertIsNone(longer.poll(), "the first run ended too soon to see the other's end")
        told = longer.communicate(timeout=200)[0]
        self.assertEqual((done.returncode, longer.returncode), (0, 0), done.stderr + told)
        self.assertNotIn("unable to open", told)
        self.assertEqual(os.listdir(self.path("temporary")), [])

    def test_an_unconverged_solve_is_named(self):
        self.fail_with("pressure solve", "after 1 iterations", "method.pressure.solver: isph",
                       values={"method.pressure.stop": "residual", "method.pressure.residual": "1e-14",
                               "method.pressure.max_iterations": "1"})

    def test_a_step_below_the_least_is_named(self):
        self.fail_with("time.min_step", values={"time.rule": "cfl", "time.step": "0", "time.min_step": "0.01"})


class DiskFull(Workplace):
    """Needs a small file system of its own, which only root may mount."""

    def setUp(self):
        super().setUp()
        os.mkdir(self.path("disk"))
        mounted = subprocess.run(["mount", "-t", "tmpfs", "-o", "size=1000k", "tmpfs", self.path("disk")],
                                 capture_output=True)
        if mounted.returncode != 0:
            self.skipTest("mounting is not allowed here")
        self.addCleanup(subprocess.run, ["umount", "-l", self.path("disk")])

    def test_the_run_fails_and_the_last_checkpoint_is_intact(self):
        # A checkpoint has 170 kB, and two stand while one is written; frames of 46 kB fill the rest in 10 intervals.
        done = self.run_scene(DAM, "disk/run", RANKS, {
            "time.end": "0.4", "output.interval": "0.01", "output.checkpoint_interval": "0.01",
            "output.checkpoints_kept": "1", "max_lost_fraction": "0.1"}, code=3)
        self.assertIn("No space left", done.stderr)
        kept = self.checkpoints("disk/run")
        self.assertTrue(kept, "no checkpoint")
        self.assertFalse([path for path in kept if path.endswith(".tmp")])
        for path in kept:
            self.assertRegex(self.treacle("info", path).stdout, r"checksums +right")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    RANKS = int(sys.argv.pop(3))
    harness.main(sys.argv, __doc__)
