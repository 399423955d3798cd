#!/usr/bin/env python3
"""Cameras from files: poses in a scene, pictures through a real lens, and messages about bad input.

usage: calibrate_test.py PROGRAM MPIEXEC
"""
import os
import re
import sys

import numpy

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "tools"))

import harness  # noqa: E402
from claims_lib import lens as optics  # noqa: E402
from claims_lib import seeing_cameras as boards  # noqa: E402
from harness import Workplace  # noqa: E402

LENS = optics.Lens(320, 240, (280.0, 282.0, 163.0, 117.0, -0.2, 0.05, 0.001, -0.001, 0, 0, 0, 0))
PLAIN = """image_width: 320
image_height: 240
camera_matrix: [[280, 0, 163], [0, 282, 117], [0, 0, 1]]
distortion_coefficients: [-0.2, 0.05, 0.001, -0.001]
"""
SCENE = """schema_version: 1
title: A block
domain: {{min: [0, 0, 0], max: [0.2, 0.1, 0.1], spacing: 1 cm}}
liquids: [{{name: syrup, density: 1000, viscosity: 10, shapes: [{{box: {{min: [0, 0, 0], max: [0.1, 0.1, 0.06]}}}}]}}]
bodies: [{{name: post, shape: {{box: {{min: [0.15, 0.04, 0], max: [0.18, 0.07, 0.08]}}}}}}]
method: {{kind: grid}}
time: {{end: 2 ms, rule: fixed, step: 1 ms}}
output: {{interval: 1 ms}}
cameras: [{cameras}]
"""
POINTS = numpy.array([[x, y, z] for x in (0, 0.2) for y in (0, 0.1) for z in (0, 0.1)])


def pose():
    """World to camera, from in front and above."""
    forward = numpy.array([-0.1, 0.9, -0.42])
    forward /= numpy.linalg.norm(forward)
    right = numpy.cross(forward, [0, 0, 1])
    right /= numpy.linalg.norm(right)
    turn = numpy.array([right, numpy.cross(forward, right), forward])
    return turn, -turn @ (numpy.array([0.1, 0.05, 0.05]) - 0.45 * forward)


class Cameras(Workplace):
    def write(self, name, text):
        with open(self.path(name), "w") as file:
            file.write(text)
        return name

    def points(self):
        seen = optics.project(LENS, *pose(), POINTS)
        rows = [", ".join(f"{value:.6f}" for value in (*(100 * point), *pixel)) for point, pixel in zip(POINTS, seen)]
        return self.write("points.csv", "x [cm], y [cm], z [cm], u, v\n" + "\n".join(rows) + "\n")

    def camera(self):
        self.write("lens.yaml", PLAIN)
        self.treacle("calibrate", "--camera", "lens.yaml", "--points", self.points(), "--out", "camera.yaml")
        return "camera.yaml"

    def picture(self, name):
        with open(self.path(name), "rb") as file:
            return file.read()

    def test_scene_is_drawn_through_the_lens_that_was_posed_by_points(self):
        self.camera()
        found = optics.read_camera(self.pathlib("camera.yaml"))
        turn, shift = pose()
        self.assertLess(abs(optics.rotation(found["rotation_vector"]) - turn).max(), 1e-5)
        self.assertLess(abs(found["translation_vector"] - shift).max(), 1e-5)
        scene = self.write("scene.yaml", SCENE.format(cameras="{name: real, file: camera.yaml}"))
        self.treacle("check", scene, "--picture", "start.png")
        self.treacle("run", scene, "--out", "run", ranks=2)
        with open(self.path("run", "effective.yaml")) as file:
            effective = file.read()
        self.assertIn("fx: 280", effective)
        os.remove(self.path("camera.yaml"))  # a run stands by itself
        for ranks in (1, 2):
            self.treacle("render", "run", "--no-movie", "--out", f"pictures{ranks}", ranks=ranks)
        names = sorted(os.listdir(self.path("pictures1")))
        self.assertEqual(names, sorted(os.listdir(self.path("pictures2"))))
        for name in names:
            self.assertEqual(self.picture(os.path.join("pictures1", name)), self.picture(os.path.join("pictures2", name)))
        drawn = optics.read_png(self.path("pictures1", names[0]))
        self.assertEqual(drawn.shape, (240, 320))
        # The top front edge of the block, at the pixel of the lens model: liquid below, none above.
        at = optics.project(LENS, turn, shift, numpy.array([[0.05, 0.0, 0.06]]))[0]
        above, below = (drawn[int(round(at[1])) + step, int(round(at[0]))] for step in (-4, 4))
        self.assertGreater(abs(above - below), 0.05)

    def pathlib(self, name):
        import pathlib

        return pathlib.Path(self.path(name))

    def test_overlay_and_refinement_on_the_outline(self):
        self.camera()
        scene = self.write("scene.yaml", SCENE.format(cameras="{name: real, file: camera.yaml}"))
        turn, shift = pose()
        u, v = numpy.meshgrid(numpy.arange(320.0), numpy.arange(240.0))
        x, y = LENS.rays(u, v)
        origin, direction = -turn.T @ shift, numpy.stack([x, y, numpy.ones_like(x)], axis=-1) @ turn
        near, far = -origin / direction, (numpy.array([0.1, 0.1, 0.06]) - origin) / direction
        inside = numpy.minimum(near, far).max(axis=-1) < numpy.maximum(near, far).min(axis=-1)
        optics.write_png(self.pathlib("mask.png"), numpy.where(inside, 0, 255).astype(numpy.uint8))
        done = self.treacle("calibrate", "--camera", "camera.yaml", "--scene", scene, "--contour", "mask.png", "--overlay", "overlay.png",
                            "--frame", "mask.png", "--out", "refined.yaml")
        self.assertGreater(float(re.search(r"-> ([\d.]+)", done.stdout)[1]), 0.99)
        self.assertEqual(optics.read_png(self.path("overlay.png")).shape, (240, 320))
        refined = optics.read_camera(self.pathlib("refined.yaml"))
        seen = optics.project(LENS, optics.rotation(refined["rotation_vector"]), refined["translation_vector"], POINTS)
        self.assertLess(abs(seen - optics.project(LENS, turn, shift, POINTS)).max(), 0.5)

    def test_board_in_the_scene_gives_the_pose_and_a_level_the_vertical(self):
        lens = boards.BOARD_LENS
        random = numpy.random.default_rng(3)
        turn, shift = boards.board_pose(lens, random, (1, 1))
        optics.write_png(self.pathlib("board.png"), boards.draw_board(lens.corner_rays(), turn, shift, random, 1))
        self.write("lens.yaml", boards.POSE_LENS.format(lens.width, lens.height, *lens.values[:4], ", ".join(map(repr, lens.values[4:]))))
        # Scene: rows of the board along x, columns along -z, so that the board's z looks along y; 2 mm in front of the place.
        origin, thickness = numpy.array([0.01, 0.02, 0.03]), 0.002
        axes = numpy.array([[1, 0, 0], [0, 0, -1], [0, 1, 0]])  # of the board, rows
        place = "1 2 3 cm; 1 0 0; 0 0 -1; 2 mm"
        size = f"{boards.COLUMNS}x{boards.ROWS}"
        # The vertical: a level on the planes y = 2 cm and x = 5 cm, tilted by 0.02 about y.
        on_walls = numpy.array([[x, 0.02, 0.01 - 0.02 * x] for x in (0, 0.03, 0.06)] + [[0.05, y, 0.01 - 0.001] for y in (0.01, 0.03)])

        def to_camera(points):
            on_board = (points - origin) @ axes.T + [0, 0, thickness]
            return optics.project(lens, turn, shift, on_board)

        rows = [f"{u:.4f}, {v:.4f}, " + ("y = 2 cm" if k < 3 else "x = 5 cm") for k, (u, v) in enumerate(to_camera(on_walls))]
        self.write("level.csv", "u, v, plane\n" + "\n".join(rows) + "\n")
        done = self.treacle("calibrate", "--camera", "lens.yaml", "--pose-picture", "board.png", "--board", size, "--square", f"{boards.SQUARE} m",
                            "--board-in-scene", place, "--level", "level.csv", "--out", "posed.json")
        self.assertTrue(os.path.exists(self.path("posed_board.png")))
        self.treacle("calibrate", "--camera", "posed.json", "--points", self.points_of(to_camera, origin), "--out", "same.yaml")
        up = [float(word) for word in re.search(r"vertical from the level: (.*) \+-", done.stdout)[1].split(",")]
        self.assertLess(abs(numpy.array(up) - [0.02, 0, 1]).max(), 0.002)
        self.assertIn("deg from that of the scene", done.stdout)

    def points_of(self, to_camera, origin):
        """Points whose pixels are the true ones: the pose of the board must agree with theirs to 0.1 pixel."""
        points = origin + POINTS * [0.5, 0.2, -0.5]
        rows = [", ".join(f"{value:.6f}" for value in (*point, *pixel)) for point, pixel in zip(points, to_camera(points))]
        self.write("true.csv", "x, y, z, u, v\n" + "\n".join(rows) + "\n")
        import json

        with open(self.path("posed.json")) as file:
            posed = json.load(file)
        turn, shift = optics.rotation(posed["rotation_vector"]["data"]), numpy.array(posed["translation_vector"]["data"])
        moved = optics.project(boards.BOARD_LENS, turn, shift, points) - to_camera(points)
        self.assertLess(abs(moved).max(), 0.3)
        return "true.csv"

    def refused(self, *arguments, ranks=1):
        before = set(os.listdir(self.folder))
        done = self.treacle(*arguments, ranks=ranks, code=2)
        self.assertEqual(before, set(os.listdir(self.folder)), arguments)
        return done.stderr

    def test_check_says_what_is_wrong_with_a_camera(self):
        self.camera()
        cases = {"file: lens.yaml": ["lens.yaml: the camera main has no pose", "treacle calibrate"],
                 "file: none.yaml": ["scene.yaml:9: the camera file none.yaml was not found"],
                 "file: camera.yaml, width: 240, height: 320": ["has 240 x 320 pixels", "calibrated for 320 x 240", "turned by a quarter"],
                 "file: camera.yaml, position: [1, 1, 1]": ["cameras.0.position", "cannot go with file"],
                 "file: camera.yaml, camera: left": ["holds no camera left", "there are main"]}
        for text, expected in cases.items():
            scene = self.write("scene.yaml", SCENE.format(cameras="{" + text + "}"))
            for ranks in (1, 2):
                said = self.refused("check", scene, ranks=ranks)
                for words in expected:
                    self.assertIn(words, said)

    def test_calibrate_refuses_bad_input(self):
        self.write("lens.yaml", PLAIN)
        os.mkdir(self.path("empty"))
        os.mkdir(self.path("grey"))
        for k in range(4):
            optics.write_png(self.pathlib(f"grey/{k}.png"), numpy.full((48, 64), 100, numpy.uint8))
        self.write("few.csv", "x, y, z, u, v\n0, 0, 0, 1, 1\n")
        self.write("words.csv", "x, y, z, u, v\n0, 0, zero, 1, 1\n")
        cases = [(["grey"], ["--square: is missing"]), (["grey", "--square", "25 mm", "--board", "8x6"], ["looks the same turned by 180 degrees"]),
                 (["grey", "--square", "25 mm", "--out", "c.yaml"], ["found in 0 of 4 pictures", "3.png: no chessboard with 9 x 6"]),
                 (["empty", "--square", "25 mm"], ["empty: holds no pictures"]), ([], ["no pictures and no camera"]),
                 (["--camera", "lens.yaml"], ["nothing is asked for"]), (["--camera", "lens.yaml", "--points", "few.csv"], ["few.csv:2: 1 points do not fix a pose"]),
                 (["--camera", "lens.yaml", "--points", "words.csv"], ["words.csv:2", "zero"]),
                 (["--camera", "lens.yaml", "--contour", "grey/0.png"], ["--contour: needs the scene", "--scene"])]
        for arguments, expected in cases:
            said = self.refused("calibrate", *arguments)
            for words in expected:
                self.assertIn(words, said, arguments)
        self.assertIn("looks the same", self.refused("calibrate", "grey", "--square", "25 mm", "--board", "8x6", ranks=2))


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    harness.main(sys.argv, __doc__)
