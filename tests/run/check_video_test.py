#!/usr/bin/env python3
"""treacle check-video names what is wrong with a clip; it ends with exit code 2 where the clip cannot be used.

usage: check_video_test.py PROGRAM MPIEXEC
"""
import json
import sys

import numpy

import harness
import silhouettes_test as films
from harness import Workplace

GROWING = [0] * 8 + [10, 14, 18, 22, 24, 26, 26, 26]


class CheckVideo(Workplace):
    def check(self, *options, code=0, ranks=1):
        done = self.treacle("check-video", "film", "--rate", 25, "--json", "check.json", *options, code=code, ranks=ranks)
        with open(self.path("check.json")) as file:
            return done.stdout, json.load(file)

    def test_good_clip_on_two_ranks(self):
        films.film(self.path("film"), GROWING)
        text, found = self.check(ranks=2)
        self.assertIn("the clip can be used", text)
        self.assertIn("160 x 120 pixels, landscape", text)
        self.assertTrue(found["usable"])
        self.assertEqual(found["first_change"], 8)
        self.assertAlmostEqual(found["rate_hz"], 25)
        self.assertFalse(found["variable_rate"])
        self.assertAlmostEqual(found["noise"], 1.5, delta=0.3)
        self.assertAlmostEqual(found["contrast"], 150, delta=8)
        self.assertLess(found["camera_shift_px"], 0.1)
        self.assertEqual(found["doubled"], [])

    def test_pixels_per_millimetre_by_the_camera(self):
        films.film(self.path("film"), GROWING)
        for width, code, text in ((160, 0, "0.400 px per mm"), (320, 2, "the camera is for 320 x 120 pixels")):
            with open(self.path("camera.yaml"), "w") as file:
                file.write(f"image_width: {width}\nimage_height: 120\ncamera_matrix: {{rows: 3, cols: 3, data: [200, 0, 80, 0, 200, 60, 0, 0, 1]}}\n"
                           "distortion_coefficients: []\nrotation_vector: [0, 0, 0]\ntranslation_vector: [0, 0, 0.4]\n")
            done, found = self.check("--camera", "camera.yaml", "--at", 0, 0, 0.1, code=code)
            self.assertIn(text, done)
        done = self.treacle("check-video", "film", "--rate", 25, "--camera", "none.yaml", code=2)
        self.assertIn("none.yaml", done.stderr)

    def test_nothing_moves(self):
        films.film(self.path("film"), [0] * 8)
        text, found = self.check(code=2)
        self.assertIn("problem: nothing moves in it", text)
        self.assertIn("the clip cannot be used as it is", text)
        self.assertFalse(found["usable"])

    def test_camera_that_moves(self):
        films.film(self.path("film"), GROWING)
        # The last frames show another part of the scene.
        for k in range(12, 16):
            picture = numpy.roll(films.texture(seed=9)[..., None] + numpy.zeros(3) + 150, 37, axis=1)
            films.write_png(self.path("film", f"f_{k:03d}.png"), numpy.clip(picture, 0, 255).astype(numpy.uint8))
        text, found = self.check(code=2)
        self.assertIn("problem: the camera moves:", text)
        self.assertIn("% of the background has changed in frame 1", text)
        done = self.treacle("silhouettes", "film", "--rate", 25, "--out", "out", code=2)
        self.assertRegex(done.stderr, "frame 1[23]: the camera moves: [0-9.]+ % of the background has changed")

    def test_doubled_frames_drift_and_gaps(self):
        films.film(self.path("film"), GROWING, gain=[1 + 0.01 * k for k in range(16)])
        with open(self.path("film", "f_010.png"), "rb") as file:
            picture = file.read()
        with open(self.path("film", "f_011.png"), "wb") as file:
            file.write(picture)
        times = [k / 25 for k in range(16)]
        times[14:] = [16 / 25, 17 / 25]
        with open(self.path("times.csv"), "w") as file:
            file.write("time [s]\n" + "".join(f"{time}\n" for time in times))
        done = self.treacle("check-video", "film", "--times", "times.csv", "--json", "check.json")
        with open(self.path("check.json")) as file:
            found = json.load(file)
        self.assertEqual(found["doubled"], [11])
        self.assertEqual(found["dropped"], 2)
        self.assertAlmostEqual(found["brightness"][1], 1.15, delta=0.03)
        for text in ("1 frames repeat the one before, the first of them frame 11", "2 frames are missing", "the exposure drifts"):
            self.assertIn("warning: " + text, done.stdout)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
