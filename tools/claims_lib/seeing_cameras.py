"""Rows of `seeing` on cameras: calibration on rendered and real boards, poses in the scene, the boxes of ViRheometry."""

import os
import pathlib
import re

import numpy

from . import lens as optics
from .run import scratch, treacle
from .table import Figure, Unmeasured

# ---- rendered boards ----

COLUMNS, ROWS, SQUARE = 9, 6, 0.025  # inner corners, [m]
BOARD_LENS = optics.Lens(1280, 720, (1105.0, 1102.0, 652.0, 349.0, -0.17, 0.09, 0.0006, -0.0009, -0.02, 0, 0, 0))
FITTED = 9  # parameters: fx fy cx cy k1 k2 p1 p2 k3
BOARDS = 24


def board_pose(lens, random, target):
    """The board at a random distance and tilt, its middle seen near the pixel `target`; the whole board in the picture."""
    corners = numpy.array([[x, y, 0] for x in (-1.6, COLUMNS + 0.6) for y in (-1.6, ROWS + 0.6)]) * SQUARE
    middle = numpy.array([(COLUMNS - 1) / 2, (ROWS - 1) / 2, 0]) * SQUARE
    for attempt in range(2000):
        shrink = 0.9985 ** attempt  # of the tilt and the way from the middle of the picture
        angle = random.uniform(0, 2 * numpy.pi)
        tilt = random.uniform(0.2, 0.75)
        turn = optics.rotation([tilt * numpy.cos(angle), tilt * numpy.sin(angle), 0]) @ optics.rotation([0, 0, random.uniform(-0.4, 0.4)])
        depth = random.uniform(0.33, 0.6)
        pixel = numpy.array([lens.width, lens.height]) / 2 * (1 + (numpy.array(target) - 1) * shrink)
        x, y = lens.rays(*(numpy.array([p]) for p in pixel))
        shift = depth * numpy.array([x[0], y[0], 1]) - turn @ middle
        seen = optics.project(lens, turn, shift, corners)
        if (seen > 4).all() and (seen < numpy.array([lens.width, lens.height]) - 5).all():
            return turn, shift
    raise RuntimeError("no place for the board")


def draw_board(rays, turn, shift, random, noise):
    """A picture of the board on a grey table: light that falls off to the rim, blur of 0.8 pixel, noise."""

    def tone(x, y):
        # Where the ray (x, y, 1) meets the plane of the board.
        along = (turn[:, 2] @ shift) / (turn[0, 2] * x + turn[1, 2] * y + turn[2, 2])
        point = [along * a - s for a, s in zip((x, y, 1.0), shift)]
        u, v = (sum(turn[k, axis] * point[k] for k in range(3)) / SQUARE for axis in (0, 1))
        dark = (numpy.floor(u) + numpy.floor(v)) % 2 == 0
        board = (u > -1) & (u < COLUMNS) & (v > -1) & (v < ROWS)
        paper = (u > -1.6) & (u < COLUMNS + 0.6) & (v > -1.6) & (v < ROWS + 0.6)
        return numpy.where(board & dark, 35, numpy.where(paper, 215, 110))

    picture = optics.blurred(optics.average(rays, tone), 0.8)
    height, width = picture.shape
    row, column = numpy.mgrid[:height, :width]
    light = 1 - 0.35 * ((column / width - 0.4) ** 2 + (row / height - 0.5) ** 2)
    return numpy.clip(numpy.rint(picture * light + random.normal(0, noise, picture.shape)), 0, 255).astype(numpy.uint8)


def distortion_error(found, truth):
    """Largest difference [pixels] of the shifts by the distortion, over the rays of the picture."""
    u, v = (a.ravel() for a in numpy.meshgrid(numpy.linspace(0, truth.width - 1, 41), numpy.linspace(0, truth.height - 1, 25)))
    x, y = truth.rays(u, v)
    a, b = found.distort(x, y), truth.distort(x, y)
    return float(numpy.hypot(truth.values[0] * (a[0] - b[0]), truth.values[1] * (a[1] - b[1])).max())


def calibrate_once(context, folder, seed, rays, boards=BOARDS, noise=3):
    random = numpy.random.default_rng(seed)
    folder.mkdir()
    targets = [(0.35 + 0.65 * i, 0.4 + 0.6 * j) for i in range(3) for j in range(3)]
    for k in range(boards):
        pose = board_pose(BOARD_LENS, random, targets[k % len(targets)])
        optics.write_png(folder / f"board_{k:02}.png", draw_board(rays, *pose, random, noise))
    whole = (folder / "board_00.png").read_bytes()
    (folder / "board_zz.png").write_bytes(whole[:len(whole) * 2 // 3])
    out = folder / "camera.yaml"
    done = treacle(context, "calibrate", folder, "--square", f"{SQUARE} m", "--out", out, ranks=0)
    camera = optics.read_camera(out)
    found = optics.lens_of(camera)
    errors = numpy.array(found.values[:FITTED]) - numpy.array(BOARD_LENS.values[:FITTED])
    return {"named": bool(re.search(r"board_zz.png .*unreadable: the file is cut off", done.output)),
            "focal": max(abs(errors[0]) / BOARD_LENS.values[0], abs(errors[1]) / BOARD_LENS.values[1]),
            "distortion": distortion_error(found, BOARD_LENS), "rms": camera["reprojection_error"],
            "scores": errors / camera["intrinsic_deviations"][:FITTED]}


def rendered_boards(context):
    repeats = context.pick(20, 4, 2)
    rays = BOARD_LENS.corner_rays()
    with scratch(context, "boards") as folder:
        found = [calibrate_once(context, folder / str(seed), seed, rays) for seed in range(repeats)]
    scores = numpy.array([one["scores"] for one in found])
    inside = (abs(scores) <= 2).sum(axis=0)
    focal, distortion = max(one["focal"] for one in found), max(one["distortion"] for one in found)
    least = numpy.ceil(0.9 * repeats) if repeats == 20 else repeats - 1
    named = sum(one["named"] for one in found)
    text = (f"{repeats} repeats of {BOARDS} boards: focal lengths within {100 * focal:.3f} %, distortion within {distortion:.3f} px, "
            f"errors {min(one['rms'] for one in found):.3f} to {max(one['rms'] for one in found):.3f} px; inside 2 s.d. "
            + ", ".join(f"{name} {n}" for name, n in zip(optics.NAMES, inside))
            + f"; r.m.s. of error over s.d. {numpy.sqrt((scores ** 2).mean()):.2f}; corrupt picture named {named}")
    return Figure(text, bool(focal <= 0.002 and distortion <= 0.1 and (inside >= least).all() and named == repeats))
