"""Rows of `seeing` on cameras: calibration on rendered and real boards, poses in the scene, the boxes of ViRheometry."""

import os
import pathlib
import re

import numpy

from . import lens as optics
from .run import scratch, treacle
from .table import Figure, Unmeasured

# ---- rendered boards ----

COLUMNS, ROWS, SQUARE = 15, 10, 0.014  # inner corners, [m]
BOARD_LENS = optics.Lens(1280, 720, (1105.0, 1102.0, 652.0, 349.0, -0.17, 0.09, 0.0006, -0.0009, -0.02, 0, 0, 0))
FITTED = 9  # parameters: fx fy cx cy k1 k2 p1 p2 k3
BOARDS, NOISE, RIM = 40, 1.5, 1.25  # pictures; [grey levels] of a contrast of 180; [squares] of paper around the corners
CHOICES = 3  # of poses a picture


def a_pose(lens, random, target):
    """The board at a random distance and tilt, its middle seen near the pixel `target`; the whole board in the picture."""
    rim = numpy.array([[x, y, 0] for x in (-RIM, COLUMNS - 1 + RIM) for y in (-RIM, ROWS - 1 + RIM)]) * SQUARE
    middle = numpy.array([(COLUMNS - 1) / 2, (ROWS - 1) / 2, 0]) * SQUARE
    for attempt in range(2000):
        shrink = 0.9985 ** attempt  # of the tilt and the way from the middle of the picture
        angle = random.uniform(0, 2 * numpy.pi)
        tilt = random.uniform(0.2, 0.75)
        turn = optics.rotation([tilt * numpy.cos(angle), tilt * numpy.sin(angle), 0]) @ optics.rotation([0, 0, random.uniform(-0.4, 0.4)])
        depth = random.uniform(0.3, 0.5)
        pixel = numpy.array([lens.width, lens.height]) / 2 * (1 + (numpy.array(target) - 1) * shrink)
        x, y = lens.rays(*(numpy.array([p]) for p in pixel))
        shift = depth * numpy.array([x[0], y[0], 1]) - turn @ middle
        seen = optics.project(lens, turn, shift, rim)
        if (seen > 4).all() and (seen < numpy.array([lens.width, lens.height]) - 5).all():
            return turn, shift
    raise RuntimeError("no place for the board")


def board_pose(lens, random, target):
    """Of some poses the one that brings a corner of the board nearest to the rim or corner of the picture at `target`, as the advice
    for taking pictures has it: what no board reaches is extrapolated."""
    corners = numpy.array([[x, y, 0] for x in (0, COLUMNS - 1) for y in (0, ROWS - 1)]) * SQUARE
    aim = numpy.array([lens.width, lens.height]) / 2 * (1 + numpy.sign(numpy.array(target) - 1))
    poses = [a_pose(lens, random, target) for _ in range(CHOICES)]
    return min(poses, key=lambda pose: numpy.linalg.norm(optics.project(lens, *pose, corners) - aim, axis=1).min())


def draw_board(rays, turn, shift, random, noise):
    """A picture of the board on a grey table: light that falls off to the rim, blur of 0.8 pixel, noise."""

    def tone(x, y):
        # Where the ray (x, y, 1) crosses the plane of the board.
        along = (turn[:, 2] @ shift) / (turn[0, 2] * x + turn[1, 2] * y + turn[2, 2])
        point = [along * a - s for a, s in zip((x, y, 1.0), shift)]
        u, v = (sum(turn[k, axis] * point[k] for k in range(3)) / SQUARE for axis in (0, 1))
        dark = (numpy.floor(u) + numpy.floor(v)) % 2 == 0
        board = (u > -1) & (u < COLUMNS) & (v > -1) & (v < ROWS)
        paper = (u > -RIM) & (u < COLUMNS - 1 + RIM) & (v > -RIM) & (v < ROWS - 1 + RIM)
        return numpy.where(board & dark, 35, numpy.where(paper, 215, 110))

    picture = optics.blurred(optics.average(rays, tone), 0.8)
    height, width = picture.shape
    row, column = numpy.mgrid[:height, :width]
    light = 1 - 0.35 * ((column / width - 0.4) ** 2 + (row / height - 0.5) ** 2)
    return numpy.clip(numpy.rint(picture * light + random.normal(0, noise, picture.shape)), 0, 255).astype(numpy.uint8)


def distortion_error(found, truth):
    """Largest difference [pixels] over the picture between the images of one ray in two lenses, apart from what focal lengths and
    a turn of the camera explain: the former have a figure of their own, the latter belongs to the pose."""
    u, v = (a.ravel() for a in numpy.meshgrid(numpy.linspace(0, truth.width - 1, 41), numpy.linspace(0, truth.height - 1, 25)))
    x, y = truth.rays(u, v)
    difference = numpy.concatenate(found.pixels(x, y)) - numpy.concatenate([u, v])
    step, zero = 1e-6, numpy.zeros_like(u)
    turns = [(0 * x, -1 + 0 * x, y), (1 + 0 * x, 0 * x, -x), (-y, x, 0 * x)]
    columns = [(numpy.concatenate(truth.pixels((x + step * a) / (1 + step * c), (y + step * b) / (1 + step * c))) - numpy.concatenate([u, v])) / step
               for a, b, c in turns]
    columns += [numpy.concatenate([u - truth.values[2], zero]), numpy.concatenate([zero, v - truth.values[3]])]
    matrix = numpy.stack(columns, axis=1)
    left = difference - matrix @ numpy.linalg.lstsq(matrix, difference, rcond=None)[0]
    return float(numpy.hypot(*left.reshape(2, -1)).max())


def calibrate_once(context, folder, seed, rays, boards=BOARDS, noise=NOISE):
    random = numpy.random.default_rng(seed)
    folder.mkdir()
    targets = [(0.35 + 0.65 * i, 0.4 + 0.6 * j) for i in range(3) for j in range(3)]
    for k in range(boards):
        pose = board_pose(BOARD_LENS, random, targets[k % len(targets)])
        optics.write_png(folder / f"board_{k:02}.png", draw_board(rays, *pose, random, noise))
    whole = (folder / "board_00.png").read_bytes()
    (folder / "board_zz.png").write_bytes(whole[:len(whole) * 2 // 3])
    out = folder / "camera.yaml"
    done = treacle(context, "calibrate", folder, "--board", f"{COLUMNS}x{ROWS}", "--square", f"{SQUARE} m", "--out", out, ranks=0)
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
        return boards_figure([calibrate_once(context, folder / str(seed), seed, rays) for seed in range(repeats)])


def boards_figure(found):
    repeats = len(found)
    scores = numpy.array([one["scores"] for one in found])
    inside = (abs(scores) <= 2).sum(axis=0)
    focal, distortion = max(one["focal"] for one in found), max(one["distortion"] for one in found)
    least = numpy.ceil(0.9 * repeats) if repeats == 20 else repeats - 1
    named = sum(one["named"] for one in found)
    text = (f"{repeats} repeats of {BOARDS} boards, noise {NOISE} grey levels: focal lengths within {100 * focal:.3f} %, distortion within {distortion:.3f} px, "
            f"errors {min(one['rms'] for one in found):.3f} to {max(one['rms'] for one in found):.3f} px; inside 2 s.d. "
            + ", ".join(f"{name} {n}" for name, n in zip(optics.NAMES, inside))
            + f"; r.m.s. of error over s.d. {numpy.sqrt((scores ** 2).mean()):.2f}; corrupt picture named {named}")
    return Figure(text, bool(focal <= 0.002 and distortion <= 0.1 and (inside >= least).all() and named == repeats))


# ---- real boards ----

# OpenCV's own calibration of the thirteen pictures, windows of 11 pixels, with its standard deviations [pixels].
REFERENCE = {"fx": (536.1, 1.5), "fy": (536.0, 1.5), "cx": (342.4, 1.5), "cy": (235.5, 1.5)}


def shared_data(context, name):
    folder = pathlib.Path(os.environ.get("TREACLE_SHARED_DATA", context.root.parent / "shared/data")) / name
    if not folder.exists():
        raise Unmeasured(f"needs {folder}")
    return folder


def picture_errors(output):
    """Error [pixels] by picture, and those named as outliers, of what treacle calibrate prints."""
    rows = re.findall(r"^(\S+\.\w+) +([\d.]+)  [\d.]+(  outlier)?", output, re.MULTILINE)
    return {name: float(error) for name, error, _ in rows}, [name for name, _, outlier in rows if outlier]


def real_boards(context):
    pictures = shared_data(context, "calibration")
    with scratch(context, "calibration") as folder:
        def run(name, *options):
            done = treacle(context, "calibrate", pictures, "--square", "25 mm", "--out", folder / f"{name}.yaml", *options, ranks=0)
            return done.output, optics.read_camera(folder / f"{name}.yaml")

        _, reference = run("reference", "--window", "11", "--outliers", "1e9")
        windows, cleaned = run("cleaned", "--window", "11")
        output, own = run("own")
    values = dict(zip(optics.NAMES, optics.lens_of(reference).values))
    agrees = all(abs(values[name] - value) <= deviation for name, (value, deviation) in REFERENCE.items())
    errors, outliers = picture_errors(windows)
    own_errors, own_outliers = picture_errors(output)
    own_values = optics.lens_of(own).values
    text = (f"{len(errors)} boards found; with the reference's windows of 11 px, all pictures: "
            + ", ".join(f"{name} {values[name]:.1f}" for name in REFERENCE)
            + f"; outliers {', '.join(outliers) or 'none'} ({errors.get('left02.jpg', 0):.2f} px), without {cleaned['reprojection_error']:.3f} px; "
            f"with windows within the squares (default) {own['reprojection_error']:.3f} px, largest {max(own_errors.values()):.3f}, "
            f"outliers {', '.join(own_outliers) or 'none'}, fx {own_values[0]:.1f} +- {own['intrinsic_deviations'][0]:.1f}")
    ok = (len(errors) == 13 and agrees and outliers == ["left02.jpg"] and cleaned["reprojection_error"] <= 0.3
          and own["reprojection_error"] <= 0.3)
    return Figure(text, ok)


# ---- the boxes of ViRheometry ----

BOXES = {"Lotion_2.5_5.1_1": (5.1, 2.5, 4), "Lotion_7.0_7.0_2": (7, 7, 4), "MoisturizingMilk_2.0_3.2_2": (3.2, 2, 4),
         "MoisturizingMilk_5.9_2.9_1": (2.9, 5.9, 4.15)}  # width, height, depth [cm]

BOX_SCENE = """schema_version: 1
title: {name}
domain: {{min: [-1 cm, -1 cm, -1 cm], max: [20 cm, 12 cm, 6 cm], spacing: 2 mm, gravity: [0, -9.81, 0]}}
liquids: [{{name: fluid, density: 1000, viscosity: 10, shapes: [{{box: {{min: [0, 0, 0], max: [{0} cm, {1} cm, {2} cm]}}}}]}}]
time: {{end: 0.1}}
"""


def boxes(context):
    experiments = shared_data(context, "virheometry") / "experiments"
    texts, ok = [], True
    with scratch(context, "boxes") as folder:
        for name, size in BOXES.items():
            scene, frame = folder / f"{name}.yaml", experiments / name / "config_01.png"
            scene.write_text(BOX_SCENE.format(*size, name=name))
            done = treacle(context, "calibrate", "--camera", experiments / name / "camera_params.xml", "--scene", scene,
                           "--contour", frame, "--overlay", folder / "overlay.png", "--frame", frame, "--out", folder / "camera.yaml", ranks=0)
            before, after = map(float, re.search(r"overlap ([\d.]+) -> ([\d.]+)", done.output).groups())
            ok = ok and 0.795 <= before <= 0.885
            texts.append(f"{name} {before:.3f} (refined on the outline {after:.3f})")
    return Figure("; ".join(texts), ok)


# ---- poses ----

BLOCK = numpy.array([0.06, 0.045, 0.04])  # [m] from the origin
POINTS = numpy.array([[x, y, z] for x in (-0.03, 0.1) for y in (-0.02, 0.07) for z in (0, 0.05)])  # [m] on the apparatus
CLICKS, OUTLINE, ALIKE = 0.5, 0.2, 20  # [pixels] noise of points; of the outline, and along it correlated over
CHI_SQUARED = 10.645  # 90 % of 6 degrees of freedom

POSE_SCENE = """schema_version: 1
title: A block
domain: {{min: [-10 cm, -10 cm, 0], max: [20 cm, 20 cm, 10 cm], spacing: 2 mm}}
liquids: [{{name: syrup, density: 1000, viscosity: 10, shapes: [{{box: {{min: [0, 0, 0], max: [{0}, {1}, {2}]}}}}]}}]
time: {{end: 0.1}}
"""

POSE_LENS = """image_width: {0}
image_height: {1}
camera_matrix: [[{2}, 0, {4}], [0, {3}, {5}], [0, 0, 1]]
distortion_coefficients: [{6}]
"""


def camera_pose(random):
    """World to camera of one directed at the block from somewhere above the table, everything in the picture."""
    while True:
        azimuth, height = random.uniform(0, 2 * numpy.pi), random.uniform(0.25, 1.1)
        middle = BLOCK / 2 + random.uniform(-0.01, 0.01, 3)
        away = numpy.array([numpy.cos(azimuth) * numpy.cos(height), numpy.sin(azimuth) * numpy.cos(height), numpy.sin(height)])
        forward, roll = -away, random.normal(0, 0.05)
        right = numpy.cross(forward, [0, 0, 1])
        right /= numpy.linalg.norm(right)
        turn = optics.rotation([0, 0, roll]) @ numpy.array([right, numpy.cross(forward, right), forward])
        shift = -turn @ (middle + random.uniform(0.24, 0.36) * away)
        seen = optics.project(BOARD_LENS, turn, shift, numpy.vstack([POINTS, corners_of_block()]))
        if (seen > 5).all() and (seen < numpy.array([BOARD_LENS.width, BOARD_LENS.height]) - 6).all():
            return turn, shift


def corners_of_block():
    return numpy.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)]) * BLOCK


def points_of_block(n=5):
    """A lattice from corner to corner."""
    steps = numpy.linspace(0, 1, n)
    return numpy.array([[x, y, z] for x in steps for y in steps for z in steps]) * BLOCK


def smooth_noise(random, shape, deviation, length):
    """A Gaussian random field whose correlation falls to 1/e over `length` pixels."""
    row, column = (numpy.fft.fftfreq(n) for n in shape)
    spread = length / 2
    weight = numpy.exp(-2 * (numpy.pi * spread) ** 2 * (row[:, None] ** 2 + column[None, :] ** 2))
    field = numpy.fft.ifft2(numpy.fft.fft2(random.normal(size=shape)) * weight).real
    return field * deviation / field.std()


def block_mask(random, turn, shift):
    """Black where a ray hits the block, each pixel moved by noise that is alike over some pixels."""
    seen = optics.project(BOARD_LENS, turn, shift, corners_of_block())
    low, high = numpy.floor(seen.min(axis=0)).astype(int) - 6, numpy.ceil(seen.max(axis=0)).astype(int) + 7
    low, high = numpy.maximum(low, 0), numpy.minimum(high, [BOARD_LENS.width, BOARD_LENS.height])
    u, v = (a.astype(float) for a in numpy.meshgrid(range(low[0], high[0]), range(low[1], high[1])))
    x, y = BOARD_LENS.rays(u + smooth_noise(random, u.shape, OUTLINE, ALIKE), v + smooth_noise(random, u.shape, OUTLINE, ALIKE))
    origin = -turn.T @ shift
    direction = numpy.stack([x, y, numpy.ones_like(x)], axis=-1) @ turn
    near, far = -origin / direction, (BLOCK - origin) / direction
    inside = numpy.minimum(near, far).max(axis=-1) < numpy.maximum(near, far).min(axis=-1)
    mask = numpy.full((BOARD_LENS.height, BOARD_LENS.width), 255, numpy.uint8)
    mask[low[1]:high[1], low[0]:high[0]][inside] = 0
    return mask


def pose_once(context, folder, seed):
    random = numpy.random.default_rng(1000 + seed)
    turn, shift = camera_pose(random)
    seen = optics.project(BOARD_LENS, turn, shift, POINTS) + random.normal(0, CLICKS, (len(POINTS), 2))
    rows = [", ".join(repr(float(value)) for value in (*1e3 * point, *pixel)) for point, pixel in zip(POINTS, seen)]
    (folder / "points.csv").write_text("x [mm], y [mm], z [mm], u, v\n" + "\n".join(rows) + "\n")
    optics.write_png(folder / "mask.png", block_mask(random, turn, shift))
    out = folder / "camera.yaml"
    done = treacle(context, "calibrate", "--camera", folder / "lens.yaml", "--points", folder / "points.csv", "--point-noise", CLICKS,
                   "--scene", folder / "scene.yaml", "--contour", folder / "mask.png", "--out", out, ranks=0)
    camera = optics.read_camera(out)
    found, covariance = optics.rotation(camera["rotation_vector"]), camera["pose_covariance"].reshape(6, 6)
    error = numpy.concatenate([optics.rotation_vector(found @ turn.T), camera["translation_vector"] - shift])
    sizes = numpy.hypot(*(optics.project(BOARD_LENS, found, camera["translation_vector"], points_of_block())
                          - optics.project(BOARD_LENS, turn, shift, points_of_block())).T)
    stated = float(re.search(r"deviation at the liquid ([\d.]+)", done.output)[1])
    return {"score": error @ numpy.linalg.solve(covariance, error), "rms": numpy.sqrt((sizes ** 2).mean()), "largest": sizes.max(), "stated": stated}


def poses(context):
    count = context.pick(20, 5, 2)
    with scratch(context, "poses") as folder:
        (folder / "scene.yaml").write_text(POSE_SCENE.format(*BLOCK))
        values = BOARD_LENS.values
        (folder / "lens.yaml").write_text(POSE_LENS.format(BOARD_LENS.width, BOARD_LENS.height, *values[:4], ", ".join(map(repr, values[4:]))))
        found = [pose_once(context, folder, seed) for seed in range(count)]
    inside = sum(one["score"] <= CHI_SQUARED for one in found)
    worst, largest = max(one["rms"] for one in found), max(one["largest"] for one in found)
    text = (f"{inside} of {count} inside the 90 % region (mean of chi2/6 {numpy.mean([one['score'] for one in found]) / 6:.2f}); error over the "
            f"liquid, r.m.s. of a camera: median {numpy.median([one['rms'] for one in found]):.3f}, largest {worst:.3f} px "
            f"(one point {largest:.3f}); stated {numpy.median([one['stated'] for one in found]):.3f} px")
    least = 16 if count == 20 else count - 1
    return Figure(text, bool(inside >= least and worst <= 0.3))


def add_rows(table):
    table.row("rendered boards", claim="calibration on rendered boards with noise and one corrupt picture", asked="focal length +- 0.2 %, "
              "distortion to 0.1 px over the picture; truth inside 2 s.d. in >= 18 of 20 repeats, each parameter")(rendered_boards)
    table.row("real boards", claim="calibration of the thirteen pictures of OpenCV's samples", asked="all boards found; OpenCV's own figures "
              "within their s.d.; left02 named as the outlier, without it <= 0.3 px")(real_boards)
    table.row("poses", claim="pose from 8 listed points (+- 0.5 px), then refined on the outline of the first frame "
              "(+- 0.2 px, alike over 20 px, and steps of pixels), 20 random cameras",
              asked="90 % region holds the truth in 16 to 20; error <= 0.3 px at the liquid")(poses)
    table.row("boxes of ViRheometry", claim="the block projected over the first frame by the authors' cameras", asked="IoU 0.80 to 0.88")(boxes)
