#!/usr/bin/env python3
"""treacle render --style surface, --cut, and treacle export --to surface, on runs in space and in the plane.

usage: surface_test.py PROGRAM MPIEXEC
"""
import os
import re
import shutil
import sys

import harness
from harness import SCENES, Workplace

SMALL = ["--size", "320x180", "--no-movie"]


class Surface(Workplace):
    def setUp(self):
        super().setUp()
        self.run_scene(os.path.join(SCENES, "dam.yaml"), "run", 2, {"time.end": "20 ms"})

    def content(self, *parts):
        with open(self.path(*parts), "rb") as file:
            return file.read()

    def draw(self, out, *options, ranks=1, run="run"):
        self.treacle("render", run, "--out", out, *SMALL, *options, ranks=ranks)
        names = sorted(os.listdir(self.path(out)))
        self.assertTrue(names)
        return [self.content(out, name) for name in names]

    def test_pictures_are_the_same_on_any_number_of_ranks(self):
        for options in (["--frames", "0:"], ["--frames", "1", "--cut", "y=7 cm"], ["--frames", "1", "--cut", "20 8 10 cm; 1 1 0", "--field", "none"]):
            one = self.draw("one", "--style", "surface", *options)
            self.assertEqual(one, self.draw("three", "--style", "surface", *options, ranks=3))
            shutil.rmtree(self.path("one"))
            shutil.rmtree(self.path("three"))

    def test_a_cut_changes_the_picture_in_both_styles(self):
        for style in ("spheres", "surface"):
            whole = self.draw(style, "--style", style, "--frames", "1")
            cut = self.draw("cut_" + style, "--style", style, "--frames", "1", "--cut", "y=8 cm")
            self.assertNotEqual(whole, cut)
            self.assertEqual(cut, self.draw("two_" + style, "--style", style, "--frames", "1", "--cut", "y=8 cm", ranks=2))

    def test_a_plane_run_is_drawn(self):
        self.run_scene(os.path.join(SCENES, "column.yaml"), "plane", 1, {"time.end": "20 ms"})
        self.assertEqual(self.draw("one", "--style", "surface", run="plane"), self.draw("two", "--style", "surface", run="plane", ranks=2))
        self.assertIn("two dimensions", self.treacle("render", "plane", "--cut", "x=0.1", code=2).stderr)

    def test_bad_requests_are_refused(self):
        for options, text in ((["--cut", "x"], "is no plane"), (["--cut", "x=1 kg"], "is no plane"), (["--cut", "0 0 0; 0 0 0"], "no direction"),
                              (["--field", "none"], "--style surface"), (["--style", "surface", "--field", "presure"], "did you mean pressure")):
            self.assertIn(text, self.treacle("render", "run", *options, code=2).stderr)
        self.assertNotIn("pictures", os.listdir(self.path("run")))
        for options, text in ((["--fields", "presure"], "did you mean pressure"), (["--fields", "id"], "whole number"), (["--box", "1 2 3"], "is no box"),
                              (["--box", "1 0 0; 0 1 1"], "no part of the domain"), (["--liquid", "oil"], "there are water"),
                              (["--format", "obj", "--fields", "velocity"], "has no place in obj")):
            self.assertIn(text, self.treacle("export", "run", "--to", "surface", *options, code=2).stderr)
        self.assertIn("--box: has no effect", self.treacle("export", "run", "--to", "ply", "--box", "0 0 0; 1 1 1", code=2).stderr)

    def figures(self, *options, ranks=1, run="run", out="mesh"):
        text = self.treacle("export", run, "--to", "surface", "--check", "--out", out, *options, ranks=ranks).stdout
        self.assertEqual(text.count("check: closed, oriented, manifold"), text.count(": time "))
        return [float(volume) for volume in re.findall(r"volume ([-+.\de]+)", text)]

    def test_surfaces_are_closed_and_a_box_crops_them(self):
        whole = self.figures("--frames", "0")
        self.assertEqual(whole, self.figures("--frames", "0", ranks=3))
        # The block is 16 x 16 x 20 cm; half of it, and a box within it.
        self.assertAlmostEqual(whole[0], 0.16 * 0.16 * 0.2, delta=0.02 * whole[0])
        self.assertAlmostEqual(self.figures("--frames", "0", "--box", "0 0 0; 8 16 24 cm", ranks=2)[0], whole[0] / 2, delta=0.02 * whole[0])
        self.assertAlmostEqual(self.figures("--frames", "0", "--box", "4 4 4 cm; 12 12 12 cm")[0], 0.08**3, delta=1e-3 * 0.08**3)

    def test_each_liquid_has_a_surface_of_its_own(self):
        self.run_scene(os.path.join(SCENES, "layers.yaml"), "layers", 2, {"time.end": "10 ms"})
        both = self.figures("--frames", "0", run="layers", out="both")[0]
        parts = self.figures("--frames", "0", "--liquid", "each", run="layers", out="each", ranks=2)
        self.assertEqual(sorted(name for name in os.listdir(self.path("each")) if name.endswith(".ply")),
                         ["frame_surface_heavy_000000.ply", "frame_surface_light_000000.ply"])
        self.assertAlmostEqual(parts[0], 0.12 * 0.12 * 0.08, delta=0.04 * parts[0])
        self.assertAlmostEqual(sum(parts), both, delta=0.01 * both)

    def test_fields_are_chosen(self):
        self.treacle("export", "run", "--to", "surface", "--frames", "0", "--fields", "density,velocity,speed", "--out", "some")
        head = self.content("some", "frame_surface_000000.ply")[:1000].decode(errors="replace")
        properties = re.findall(r"property (\w+) (\w+)\n", head.split("end_header")[0])
        self.assertEqual([name for kind, name in properties], ["x", "y", "z", "density", "velocity_x", "velocity_y", "velocity_z", "speed"])
        self.assertIn("comment unit density kg/m3", head)
        self.treacle("export", "run", "--to", "surface", "--frames", "0", "--format", "obj", "--fields", "none", "--out", "bare")
        text = self.content("bare", "frame_surface_000000.obj").decode()
        self.assertNotIn("vn ", text)
        self.assertRegex(text, r"\nf \d+ \d+ \d+\n")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
