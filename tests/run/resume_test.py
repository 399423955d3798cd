#!/usr/bin/env python3
"""A run that goes on from a checkpoint ends where the straight run does.

usage: resume_test.py PROGRAM MPIEXEC
"""
import contextlib
import os
import shutil
import sys
import tempfile

import numpy

import harness
from harness import SCENES, TIGHT, TIGHT_ON_GRID, Workplace

DAM = os.path.join(SCENES, "dam.yaml")
RAFT = os.path.join(SCENES, "raft.yaml")
FLAP = os.path.join(SCENES, "flap.yaml")
POUR = os.path.join(SCENES, "pour.yaml")
LAYERS = os.path.join(SCENES, "layers.yaml")
SQUEEZE = os.path.join(SCENES, "squeeze.yaml")
THINNING = os.path.join(SCENES, "thinning.yaml")
WEDGE = """v 0.14 0.14 0.16
v 0.34 0.14 0.16
v 0.14 0.34 0.16
v 0.14 0.14 0.3
f 1 3 2
f 1 2 4
f 1 4 3
f 2 3 4
"""
WEDGE_SCENE = """schema_version: 1
title: A wedge falls on a pool
domain: {max: [0.4, 0.4, 0.4], spacing: 2 cm}
liquids:
  - {name: water, density: 1000, subtract_bodies: true, shapes: [{box: {min: [0, 0, 0], max: [0.4, 0.4, 0.14]}}]}
bodies:
  - name: wedge
    kind: dynamic
    density: 600
    shape: {mesh: {file: wedge.obj, fallback: {sphere: {centre: [0.2, 0.2, 0.22], radius: 0.06}}}}
time: {end: 80 ms, rule: fixed, step: 2 ms}
output: {interval: 20 ms, checkpoint_interval: 40 ms, checkpoints_kept: 4}
max_lost_fraction: 0.01
"""
SPACING = 0.02
# On the same ranks nothing but the checkpoint lies between the two; on others sums are in another order.
SAME_RANKS = 1e-12
OTHER_RANKS = 1e-6 * SPACING
TWICE = [(2, 2, SAME_RANKS), (3, 1, OTHER_RANKS)]  # ranks that write and that read


class Resume(Workplace):
    @classmethod
    def setUpClass(cls):
        cls.made = tempfile.mkdtemp(prefix="treacle_run_")

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.made)

    def straight(self, ranks, values=None):
        """A copy of a run of 40 steps with checkpoints after 10, 20, 30 and 40; made once."""
        name = f"{ranks}_{sorted((values or {}).items())}".replace("/", "_")
        kept = os.path.join(self.made, name)
        if not os.path.exists(kept):
            self.run_scene(DAM, kept, ranks, {**TIGHT, **(values or {})})
        shutil.copytree(kept, self.path("run"))
        shutil.copytree(kept, self.path("straight"))

    def remove_newest(self, count):
        for path in self.checkpoints("run")[-count:]:
            os.remove(path)

    def expect_the_same_end(self, tolerance):
        one, other = self.frame("straight"), self.frame("run")
        self.assertEqual(one["time"], other["time"])
        self.assertLessEqual(self.largest_move(one, other), tolerance)
        one, other = self.steps("straight"), self.steps("run")
        self.assertEqual(list(one["step"]), list(other["step"]), "each step stands in steps.csv once")

    @contextlib.contextmanager
    def resumed(self, scene, values, written, read, removed):
        """A straight run, and one without its newest checkpoints that went on from what was left."""
        with self.subTest(written=written, read=read):
            self.run_scene(scene, "run", written, values)
            shutil.copytree(self.path("run"), self.path("straight"))
            self.remove_newest(removed)
            self.treacle("resume", "run", ranks=read)
            yield
            shutil.rmtree(self.path("run"))
            shutil.rmtree(self.path("straight"))

    def resume_from(self, written, read, tolerance, values=None):
        self.straight(written, values)
        self.assertEqual(len(self.checkpoints("run")), 4)
        self.remove_newest(2)
        self.treacle("resume", "run", ranks=read)
        self.expect_the_same_end(tolerance)

    def test_on_the_same_number_of_ranks(self):
        for ranks in [1, 2, 3]:
            with self.subTest(ranks=ranks):
                self.resume_from(ranks, ranks, SAME_RANKS)
                shutil.rmtree(self.path("run"))
                shutil.rmtree(self.path("straight"))

    def test_on_another_number_of_ranks(self):
        for written, read in [(2, 1), (1, 2), (2, 4)]:
            with self.subTest(written=written, read=read):
                self.resume_from(written, read, OTHER_RANKS)
                shutil.rmtree(self.path("run"))
                shutil.rmtree(self.path("straight"))

    def test_with_bodies_that_move(self):
        for written, read, tolerance in TWICE:
            with self.resumed(RAFT, TIGHT, written, read, removed=1):
                self.expect_the_same_end(tolerance)
                one, other = self.columns("straight", "bodies.csv"), self.columns("run", "bodies.csv")
                for title in one.dtype.names:
                    if "raft position" in title or "raft rotation" in title or "paddle position" in title:
                        self.assertLessEqual(abs(one[title][-1] - other[title][-1]), tolerance, title)
                self.assertGreater(abs(one["raft velocity y [m/s]"][-1]), 1e-3, "it moves")
                self.assertEqual(len(os.listdir(self.path("straight", "frames"))),
                                 len(os.listdir(self.path("run", "frames"))), "solids of every frame")

    def test_bodies_from_files_keep_their_shapes(self):
        """The files are searched beside the scene; a run goes on from elsewhere, and ends when they are gone."""
        mesh = self.path("wedge.obj")
        with open(mesh, "w") as file:
            file.write(WEDGE)
        scene = self.path("wedge.yaml")
        with open(scene, "w") as file:
            file.write(WEDGE_SCENE)
        self.run_scene(scene, "run", 1, TIGHT)
        shutil.copytree(self.path("run"), self.path("straight"))
        self.remove_newest(1)
        shutil.copytree(self.path("run"), self.path("other"))
        self.treacle("resume", "run", ranks=1)
        self.expect_the_same_end(SAME_RANKS)
        os.remove(mesh)
        self.assertIn("wedge.obj", self.treacle("resume", "other", code=2).stderr)

    def test_with_joints(self):
        for written, read, tolerance in TWICE:
            with self.resumed(FLAP, TIGHT, written, read, removed=1):
                self.expect_the_same_end(tolerance)
                one, other = self.columns("straight", "bodies.csv"), self.columns("run", "bodies.csv")
                self.assertEqual(one.dtype.names, other.dtype.names)
                for title in one.dtype.names:
                    if "position" in title or "rotation" in title:
                        self.assertLessEqual(abs(one[title][-1] - other[title][-1]), tolerance, title)
                    if read == written and "joint force" in title:
                        self.assertEqual(one[title][-1], other[title][-1], title)
                self.assertGreater(abs(one["flap rotation z [rad]"][-1]), 1e-3, "it moves")
                self.assertGreater(abs(one["flap joint force y [N/m]"][-1]), 1, "the hinge carries it")

    def test_with_two_liquids(self):
        for written, read, tolerance in TWICE:
            with self.resumed(LAYERS, TIGHT, written, read, removed=2):
                self.expect_the_same_end(tolerance)
                self.assertEqual(sorted(set(self.frame("run")["liquid"])), [0, 1])

    def test_with_viscosities_that_vary(self):
        for written, read, tolerance in TWICE:
            with self.resumed(THINNING, {**TIGHT, "method.viscosity.residual": "1e-11"}, written, read, removed=2):
                self.expect_the_same_end(tolerance)
                one, other = self.frame("straight"), self.frame("run")
                share = SAME_RANKS if read == written else 1e-5  # the shear rates' share of the solver's residual
                self.assertLess(abs(one["viscosity"] / numpy.maximum(other["viscosity"], 1e-30) - 1).max(
                    initial=0, where=other["viscosity"] > 0), share)
                self.assertEqual(one["viscosity"].min(), 0)
                self.assertEqual(one["viscosity"].max(), numpy.float32(1e8))
                self.assertGreater(len(set(one["viscosity"])), 50)

    def test_with_inlets_and_an_outlet(self):
        tight = {**TIGHT, "method.viscosity.residual": "1e-10"}
        for written, read, tolerance in TWICE:
            with self.resumed(POUR, tight, written, read, removed=2):
                self.expect_the_same_end(tolerance)
                one, other = self.steps("straight"), self.steps("run")
                for title in ["particles", "flowed in", "flowed out"]:
                    self.assertEqual(list(one[title]), list(other[title]), title)
                self.assertEqual(other["lost by leak"][-1], 0)
                self.assertGreater(other["flowed out"][-1], 0)
                self.assertGreater(other["flowed in"][-1], other["flowed in"][20], "they flow in after the checkpoint")
                started = other["particles"] - other["flowed in"] + other["flowed out"]
                self.assertEqual(len(set(started)), 1, "none is lost and none is made otherwise")

    def test_with_inlets_an_outlet_and_shear_rates_on_the_grid(self):
        for written, read, tolerance in TWICE:
            with self.resumed(SQUEEZE, TIGHT_ON_GRID, written, read, removed=2):
                self.expect_the_same_end(tolerance)
                one, other = self.steps("straight"), self.steps("run")
                for title in ["particles", "flowed in", "flowed out", "lost by leak"]:
                    self.assertEqual(list(one[title]), list(other[title]), title)
                self.assertEqual(other["lost by leak"][-1], 0)
                self.assertGreater(other["flowed out"][-1], 0)
                self.assertGreater(other["flowed in"][-1], other["flowed in"][20], "they flow in after the checkpoint")
                started = other["particles"] - other["flowed in"] + other["flowed out"]
                self.assertEqual(len(set(started)), 1, "none is lost and none is made otherwise")
                self.assertGreater(len(set(self.frame("run")["viscosity"])), 50)

    def test_with_steps_that_follow_the_velocities(self):
        self.resume_from(2, 2, SAME_RANKS, {"time.rule": "cfl"})

    def test_with_nothing_that_limits_steps(self):
        """At rest without gravity a step lasts from frame to frame."""
        for kind in ["grid", "sph"]:
            with self.subTest(kind):
                self.run_scene(os.path.join(SCENES, "rest.yaml"), kind, 1, {"method.kind": kind})
                steps = self.steps(kind)
                numpy.testing.assert_allclose(steps["time [s]"], [0.1, 0.2])
                self.assertLess(max(steps["max speed [m/s]"]), 1e-12)

    def test_a_truncated_newest_checkpoint_is_skipped_with_a_message(self):
        self.straight(2)
        newest = self.checkpoints("run")[-1]
        os.truncate(newest, os.path.getsize(newest) // 2)
        self.remove_frames_after("run", 3)
        done = self.treacle("resume", "run", ranks=2)
        self.assertIn("skipped " + os.path.basename(newest), done.stdout + done.stderr)
        self.expect_the_same_end(SAME_RANKS)

    def remove_frames_after(self, run, count):
        """As if the run had been cut off before it wrote them."""
        folder = self.path(run, "frames")
        for name in sorted(name for name in os.listdir(folder) if name.startswith("frame_0"))[count:]:
            os.remove(os.path.join(folder, name))

    def test_without_a_valid_checkpoint_there_is_nothing_to_go_on_from(self):
        self.straight(2)
        for path in self.checkpoints("run"):
            os.truncate(path, 100)
        done = self.treacle("resume", "run", ranks=2, code=2)
        self.assertIn("no valid checkpoint", done.stderr)

    def test_a_checkpoint_of_another_scene_is_refused(self):
        self.straight(2)
        with open(self.path("run", "effective.yaml")) as file:
            text = file.read()
        with open(self.path("run", "effective.yaml"), "w") as file:
            file.write(text.replace("Small dam break", "Another dam break"))
        done = self.treacle("resume", "run", ranks=2, code=2)
        self.assertIn("another scene", done.stderr)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
