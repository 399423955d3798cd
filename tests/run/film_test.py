#!/usr/bin/env python3
"""treacle film makes videos of a run whose silhouettes treacle silhouettes finds again.

usage: film_test.py PROGRAM MPIEXEC
"""
import csv
import json
import os
import sys

import numpy

import harness
from harness import SCENES, Workplace
from silhouettes_test import read_png

RUN = {"time.end": "0.24 s", "output.interval": "20 ms"}
BLOCK = """schema_version: 1
title: A block of syrup collapses behind a post
domain: {max: [0.4, 0.2, 0.3], spacing: 2 cm}
liquids:
  - {name: syrup, density: 1000, viscosity: 5, shapes: [{box: {min: [0, 0, 0], max: [0.12, 0.2, 0.2]}}]}
bodies:
  - {name: post, shape: {box: {min: [0.2, 0.02, 0], max: [0.24, 0.06, 0.25]}}}
time: {end: 0.12 s}
output: {interval: 20 ms}
cameras:
  - {name: front, width: 320, height: 240, position: [0.2, -0.9, 0.2], target: [0.2, 0.1, 0.12]}
"""


SLUMP = """schema_version: 1
title: A block of syrup slumps on all sides
domain: {min: [-0.2, -0.2, 0], max: [0.2, 0.2, 0.2], spacing: 2 cm}
liquids:
  - {name: syrup, density: 1000, viscosity: 5, shapes: [{box: {min: [-0.08, -0.06, 0], max: [0.08, 0.06, 0.16]}}]}
bodies:
  - {name: post, shape: {box: {min: [-0.02, -0.2, 0], max: [0.02, -0.14, 0.1]}}}
method: grid
time: {end: 0.15 s}
output: {interval: 50 ms}
cameras:
  - {name: front, width: 320, height: 240, position: [0.7, -0.7, 0.4], target: [0, 0, 0.05]}
"""


class Film(Workplace):
    def rows(self, path):
        with open(self.path(path)) as file:
            return list(csv.DictReader(file))

    def masks(self, folder, count):
        return [read_png(self.path(folder, f"mask_{k:06d}.png")) for k in range(count)]

    def content(self, *parts):
        with open(self.path(*parts), "rb") as file:
            return file.read()

    def film_of_slump(self, name, axes):
        self.run_scene("slump.yaml", name, 2, {"domain.symmetry": axes})
        self.treacle("film", name, "--out", name + "_film", "--lead", 0, "--rate", 20, "--phase", 0)
        return self.masks(name + "_film", 3)

    def test_a_half_and_its_mirror_image_look_like_the_whole(self):
        with open(self.path("slump.yaml"), "w") as file:
            file.write(SLUMP)
        whole = self.film_of_slump("whole", "[]")
        half = self.film_of_slump("half", "[x]")
        with open(self.path("half", "summary.json")) as one, open(self.path("whole", "summary.json")) as other:
            self.assertEqual(2 * json.load(one)["particles"], json.load(other)["particles"])
        for k, (mask, seen) in enumerate(zip(whole, half)):
            self.assertGreater(mask.sum(), 0)
            differing = numpy.logical_xor(mask > 0, seen > 0).sum() / (mask > 0).sum()
            self.assertLess(differing, 0.04, f"frame {k}") # another seed of particles: 0.026
        self.treacle("render", "half", "--size", "160x120", "--frames", 2) # with the images of solids and surface
        for axes, values, told in [("[y]", {}, "bodies.post is not its own mirror image across y"),
                                   ("[x]", {"domain.tilt": "5 deg"}, "gravity"),
                                   ("[x]", {"liquids.syrup.velocity": "[1, 0, 0]"}, "moves across x"),
                                   ("[x]", {"domain.boundaries.x_min": "open"}, "make the two sides alike")]:
            with self.subTest(axes=axes, **values):
                done = self.run_scene("slump.yaml", "refused", 1, {"domain.symmetry": axes, **values}, code=2)
                self.assertIn(told, done.stderr)

    def test_film_of_a_plane_run_and_its_silhouettes(self):
        self.run_scene(os.path.join(SCENES, "column.yaml"), "run", 1, RUN)
        self.treacle("film", "run", "--out", "film", "--rate", 50, "--lead", 0.2, "--jitter", 0.3, "--turned", 90, "--drift", 0.1)
        rows = self.rows("film/film.csv")
        exact = self.masks("film", len(rows))
        self.assertEqual([int(row["area [px]"] != "0") for row in rows], [int(mask.any()) for mask in exact])
        stamps = numpy.array([float(row["stamp [s]"]) for row in rows])
        self.assertGreater(numpy.ptp(numpy.diff(stamps)), 0.004) # a variable rate
        numpy.testing.assert_allclose([float(row["time [s]"]) for row in rows], numpy.maximum(0, stamps - 0.2), atol=1e-9)
        self.treacle("silhouettes", "film/film.mp4", "--out", "found")
        found = self.rows("found/silhouettes.csv")
        numpy.testing.assert_allclose([float(row["stamp [s]"]) for row in found], stamps, atol=1e-4)
        for mask, seen in zip(exact, self.masks("found", len(rows))):
            self.assertEqual(mask.shape, seen.shape)
            both, either = numpy.logical_and(mask > 0, seen > 0).sum(), numpy.logical_or(mask > 0, seen > 0).sum()
            if either:
                self.assertGreater(both / either, 0.97)

    def test_the_same_film_on_any_number_of_ranks(self):
        with open(self.path("block.yaml"), "w") as file:
            file.write(BLOCK)
        self.run_scene("block.yaml", "run", 2, {})
        options = ["--rate", 24, "--lead", 0.25, "--codec", "lossless", "--exposure", 0.01, "--readout", 0.01]
        self.treacle("film", "run", "--out", "one", *options)
        self.treacle("film", "run", "--out", "two", *options, ranks=2)
        self.assertEqual(sorted(os.listdir(self.path("one"))), sorted(os.listdir(self.path("two"))))
        for name in os.listdir(self.path("one")):
            self.assertEqual(self.content("one", name), self.content("two", name), name)
        with open(self.path("one", "film.json")) as file:
            self.assertEqual(json.load(file)["camera"]["width"], 320)
        rows = self.rows("one/film.csv")
        self.treacle("silhouettes", "one/film.mp4", "--out", "found")
        last, seen = self.masks("one", len(rows))[-1] > 0, self.masks("found", len(rows))[-1] > 0
        self.assertGreater(last.sum(), 1500)
        self.assertGreater(numpy.logical_and(last, seen).sum() / numpy.logical_or(last, seen).sum(), 0.97)

    def test_bad_options_leave_nothing(self):
        self.run_scene(os.path.join(SCENES, "column.yaml"), "run", 1, {})
        for options, text in ((["--camera", "sode"], "did you mean side"), (["--from", 0.03, "--to", 0.01], "--to"), (["--rate", 0], "--rate"),
                              (["--exposure", 1], "--exposure"), (["--liquid", "1,2"], "is no light"), (["--time-map", "0:0"], "--time-map")):
            done = self.treacle("film", "run", "--out", "film", *options, code=2, ranks=2)
            self.assertIn(text, done.stderr)
            self.assertEqual(os.listdir(self.folder), ["run"])


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
