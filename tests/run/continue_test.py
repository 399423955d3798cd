#!/usr/bin/env python3
"""A run goes on for longer, or with other output; its last state has a frame and, where there are any, a checkpoint.

usage: continue_test.py PROGRAM MPIEXEC
"""
import json
import os
import sys

import harness
from harness import SCENES, TIGHT, Workplace

DAM = os.path.join(SCENES, "dam.yaml")
SAME_RANKS = 1e-12  # as in resume_test.py


class Continue(Workplace):
    def frame_times(self, run):
        with open(self.path(run, "frames", "frame.hdf.series")) as file:
            return [round(entry["time"], 9) for entry in json.load(file)["files"]]

    def text(self, *parts):
        with open(self.path(*parts)) as file:
            return file.read()

    def test_a_finished_run_goes_on_for_longer(self):
        # The second checkpoint, at the end, is due by no interval.
        self.run_scene(DAM, "run", 2, {**TIGHT, "time.end": "0.05"})
        self.assertEqual(len(self.checkpoints("run")), 3)
        self.treacle("resume", "run", "--until", "80 ms", ranks=2)
        self.run_scene(DAM, "straight", 2, TIGHT)
        self.assertEqual(list(self.steps("run")["step"]), list(range(1, 41)))
        self.assertEqual(self.frame_times("run"), [0, 0.02, 0.04, 0.05, 0.06, 0.08])
        self.assertLessEqual(self.largest_move(self.frame("straight"), self.frame("run")), SAME_RANKS)
        self.assertEqual(self.text("run", "effective.yaml"), self.text("straight", "effective.yaml"))
        manifests = [json.loads(self.text(run, "manifest.json")) for run in ["run", "straight"]]
        self.assertEqual(manifests[0]["input hash"], manifests[1]["input hash"])
        self.assertEqual(manifests[0]["resumed"][0]["changes"], ["time.end=80 ms"])
        self.assertEqual(manifests[0]["resumed"][0]["step"], 25)
        self.treacle("resume", "run")

    def test_output_may_change(self):
        self.run_scene(DAM, "run", 1, {**TIGHT, "time.end": "0.04"})
        self.treacle("resume", "run", "--set", "time.end=0.06", "--set", "output.interval=5 ms", "--set",
                     "output.fields=[velocity]", ranks=2)
        self.assertEqual(self.frame_times("run"), [0, 0.02, 0.04, 0.046, 0.05, 0.056, 0.06])  # steps of 2 ms
        self.assertNotIn("pressure", self.frame("run"))
        self.assertIn("interval: 0.005", self.text("run", "effective.yaml"))

    def test_what_the_state_follows_from_may_not_change(self):
        self.run_scene(DAM, "run", 1, {**TIGHT, "time.end": "0.04"})
        before = self.text("run", "effective.yaml"), self.text("run", "manifest.json")
        for change, reason in [("liquids.water.viscosity=2", "the state of the checkpoint follows from it"),
                               ("method.pressure.residual=1e-3", "the state of the checkpoint follows from it"),
                               ("domain.spacing=1 cm", "the state of the checkpoint follows from it"),
                               ("measurements.front.axis=y", "columns of measurements.csv"),
                               ("time.step=1 ms", "the steps of a run follow one rule"),
                               ("output.name=other", "one name"), ("output={name: other}", "one name"),
                               ("output.intervall=1 ms", "did you mean interval"), ("time.end=-1", "must be > 0"),
                               ("time.end=20 ms", "a run does not go back")]:
            done = self.treacle("resume", "run", "--set", change, code=2)
            self.assertIn("--set " + change, done.stderr)
            self.assertIn(reason, done.stderr)
        self.assertIn("--set time.step=1", self.treacle("resume", "run", "--set", "time.step=1", ranks=2, code=2).stderr)
        self.assertIn("--until 3 kg", self.treacle("resume", "run", "--until", "3 kg", code=2).stderr)
        self.assertEqual(before, (self.text("run", "effective.yaml"), self.text("run", "manifest.json")))

    def test_the_end_has_a_frame_that_is_due_by_no_interval(self):
        for name, values in [("fixed", {}), ("cfl", {"time.rule": "cfl", "time.step": "0"}), ("grid", {"method.kind": "grid"})]:
            with self.subTest(name):
                self.run_scene(DAM, name, 1, {**values, "output.interval": "0.03", "output.checkpoint_interval": "0"})
                self.assertEqual(self.frame_times(name), [0, 0.03, 0.06, 0.08])
                self.assertEqual(self.checkpoints(name), [])

    def test_measurements_keep_their_times(self):
        timed = {**TIGHT, "measurements.front.interval": "9 ms"}
        self.run_scene(DAM, "run", 1, timed)
        straight = self.text("run", "measurements.csv")
        for path in self.checkpoints("run")[-2:]:
            os.remove(path)
        self.treacle("resume", "run")
        self.assertEqual(straight, self.text("run", "measurements.csv"))

    def test_rows_of_lost_particles_stand_once(self):
        """A run that went on past its newest checkpoint before it was cut off."""
        fast = {**TIGHT, "liquids.water.velocity": "[1000, 0, 0]", "max_lost_fraction": "1", "time.end": "0.02",
                "output.checkpoint_interval": "0.01"}
        self.run_scene(DAM, "run", 1, fast)
        straight = self.text("run", "lost_particles.csv")
        self.assertEqual(len(straight.splitlines()), 641)
        with open(self.path("run", "lost_particles.csv"), "a") as file:
            file.write("11,0.022,7,2,0,0,0,0,0,0\n")
        self.treacle("resume", "run")
        self.assertEqual(straight, self.text("run", "lost_particles.csv"))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
