#!/usr/bin/env python3
"""treacle silhouettes on small films of discs, drawn here.

usage: silhouettes_test.py PROGRAM MPIEXEC
"""
import csv
import json
import os
import shutil
import struct
import sys
import zlib

import numpy

import harness
from harness import Workplace


def write_png(path, picture):
    """uint8 [height][width] or [height][width][3]."""
    height, width = picture.shape[:2]
    rows = picture.reshape(height, -1)
    data = zlib.compress(b"".join(b"\0" + row.tobytes() for row in rows))
    chunks = [(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2 if picture.ndim == 3 else 0, 0, 0, 0)), (b"IDAT", data), (b"IEND", b"")]
    with open(path, "wb") as file:
        file.write(b"\x89PNG\r\n\x1a\n")
        for name, body in chunks:
            file.write(struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body)))


def read_png(path):
    """Grey uint8 [height][width]."""
    import matplotlib.image
    picture = matplotlib.image.imread(path)
    return numpy.rint(255 * (picture if picture.ndim == 2 else picture[..., 0])).astype(numpy.uint8)


SIZE = (120, 160)
Y, X = numpy.mgrid[:SIZE[0], :SIZE[1]]


def disc(radius, x=80, y=60):
    return numpy.hypot(X - x, Y - y) <= radius


def texture(seed):
    return numpy.kron(numpy.random.default_rng(seed).uniform(-25, 25, (SIZE[0] // 4, SIZE[1] // 4)), numpy.ones((4, 4)))


def film(folder, radii, seed=1, background=180, liquid=30, gain=None):
    """Frames of a disc before a texture, with noise and, if given, a gain for each; the exact masks."""
    os.makedirs(folder, exist_ok=True)
    random = numpy.random.default_rng(seed)
    masks = [disc(radius) if radius else numpy.zeros(SIZE, bool) for radius in radii]
    for k, mask in enumerate(masks):
        light = numpy.where(mask, liquid, background + texture(seed)) * (gain[k] if gain else 1)
        picture = light[..., None] + random.normal(0, 1.5, SIZE + (3,))
        write_png(os.path.join(folder, f"f_{k:03d}.png"), numpy.clip(picture, 0, 255).astype(numpy.uint8))
    return masks


class Silhouettes(Workplace):
    def run_on(self, radii, *options, out="out", code=0, **look):
        masks = film(self.path("film"), radii, **look)
        return masks, self.treacle("silhouettes", "film", "--rate", 25, "--out", out, *options, code=code)

    def rows(self, out="out"):
        with open(self.path(out, "silhouettes.csv")) as file:
            return list(csv.DictReader(file))

    def check_masks(self, masks, out="out", allowed=8):
        for k, mask in enumerate(masks):
            found = read_png(self.path(out, f"mask_{k:06d}.png"))
            self.assertTrue(set(numpy.unique(found)) <= {0, 255})
            self.assertLessEqual(numpy.count_nonzero((found == 255) != mask), allowed, f"frame {k}")

    def test_gmm_with_the_frames_before_the_first_change(self):
        radii = [0] * 8 + [10, 14, 18, 22, 22, 22]
        masks, done = self.run_on(radii)
        self.check_masks(masks)
        rows = self.rows()
        self.assertEqual(len(rows), len(radii))
        self.assertAlmostEqual(float(rows[10]["time [s]"]), 0.4)
        self.assertAlmostEqual(float(rows[10]["centroid x [px]"]), 80, delta=0.1)
        # The opening may take the outermost pixel of a disc, which stands alone.
        box = [float(rows[13][key]) for key in ("left [px]", "top [px]", "right [px]", "bottom [px]")]
        numpy.testing.assert_allclose(box, [58, 38, 102, 82], atol=1)
        with open(self.path("out", "summary.json")) as file:
            first = json.load(file)["first_moving_frame"]
        self.assertEqual(first["frame"], 8)
        self.assertAlmostEqual(first["time_s"], 0.3)
        self.assertAlmostEqual(first["uncertainty_s"], 0.02)
        self.assertIn("first moving frame: 8", done.stdout)
        self.assertIn("progress silhouettes done=14 total=14", done.stdout)
        self.assertTrue(os.path.exists(self.path("out", "overlay.mp4")))

    def test_settings_are_written_and_read_again(self):
        self.run_on([0] * 8 + [12, 16, 20], "--method", "difference", "--set", "min_area=30")
        self.treacle("silhouettes", "film", "--rate", 25, "--out", "again", "--settings", "out/settings.yaml", ranks=2)
        names = sorted(os.listdir(self.path("out")))
        self.assertEqual(names, sorted(os.listdir(self.path("again"))))
        for name in names:
            with open(self.path("out", name), "rb") as one, open(self.path("again", name), "rb") as other:
                self.assertEqual(one.read(), other.read(), name)

    def test_bad_input_leaves_nothing(self):
        cases = {
            "nothing moves": ([0] * 10, []),
            "has no empty scene": ([5, 9, 12, 15, 18, 20], []),
            "is no range of frames": ([0] * 8 + [12, 16], ["--empty-frames", "5:2"]),
            "did you mean min_area": ([0] * 8 + [12, 16], ["--set", "min_aera=3"]),
            "is no mask": ([0] * 8 + [12, 16], ["--method", "masks"]),
            "no settings": ([0] * 8 + [12, 16], ["--settings", "no settings.yaml"]),
        }
        for text, (radii, options) in cases.items():
            shutil.rmtree(self.path("film"), ignore_errors=True)
            _, done = self.run_on(radii, *options, code=2)
            self.assertIn(text, done.stderr)
            self.assertEqual(os.listdir(self.folder), ["film"], text)


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
