"""Rows of `identify` on real dam breaks between clear walls: silhouettes of lotion and milk, beside their rheometer's curves."""

import math
import pathlib
import re
import shutil

from .run import built, execute, scratch
from .table import Figure, Unmeasured

# Height, width and depth of the block [m], spacings [mm] of the rungs.
BLOCKS = {
    "Lotion_7.0_7.0_2": (0.07, 0.07, 0.04, (7, 5, 3.5)),
    "Lotion_2.5_5.1_1": (0.025, 0.051, 0.04, (4, 3, 2.2)),
    "MoisturizingMilk_5.9_2.9_1": (0.059, 0.029, 0.0415, (5, 3.6, 2.6)),
    "MoisturizingMilk_2.0_3.2_2": (0.02, 0.032, 0.04, (3.2, 2.4, 1.8)),
}
CURVES = {"Lotion": "Lotion_20230114_1216_24C.csv", "MoisturizingMilk": "MoisturizingMilk_20230114_1312_24C.csv"}
PICTURE = (1920, 1080)

SCENE = """schema_version: 1
title: A block between a back wall and two side walls slumps
domain:
  min: [0, 0, {z_min}]
  max: [{x_max}, {y_max}, {z_max}]
  spacing: {spacing} mm
  gravity: [0, -9.81, 0]
  boundaries: {{x_min: {{slip: no_slip}}, y_min: {{slip: no_slip}}, x_max: open, y_max: open, z_min: open, z_max: open}}
liquids:
  - {{name: liquid, density: 1000, viscosity: 5 Pa.s, subtract_bodies: true, shapes: [{{box: {{min: [0, 0, 0], max: [{width}, {height}, {depth}]}}}}]}}
bodies:
  - {{name: right, slip: no_slip, shape: {{box: {{min: [-0.01, -0.01, {behind}], max: [{width}, 0.2, 0]}}}}}}
  - {{name: left, slip: no_slip, shape: {{box: {{min: [-0.01, -0.01, {depth}], max: [{width}, 0.2, {before}]}}}}}}
method: grid
time: {{end: {end}}}
"""
STUDY = """schema_version: 1
title: One viscosity for a real dam break
scenes: [{{name: block, file: scene.yaml}}]
parameters:
  - {{name: viscosity, key: liquids.liquid.viscosity, range: [0.3 Pa.s, 300 Pa.s], start: 5 Pa.s, scale: log}}
experiments:
  - name: block
    masks: masks
    camera: {camera}
    see_through: [left, right]
    time_zero: {zero} s
    from: 30 ms
    to: {last} s
    plus_minus: {{time_zero: 15 ms, turn: 5 mrad, place: 3 mm, focal: 0.01, contour: 1}}
search: {{evaluations: 12, rungs: [{rungs}], noise_runs: 2}}
"""


def quoted(text, name):
    return [float(word) for word in re.search(rf'{name}="([^"]+)"', text).group(1).split()]


def projected(text, point):
    """Pixel of a point [m] in a picture of the experiments, by their camera_params.xml."""
    w, x, y, z = quoted(text, "quat")
    eye, fov = quoted(text, "eyepos"), quoted(text, "fov")[0]
    turn = [[1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)], [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]]  # camera to world
    arm = [100 * p - e for p, e in zip(point, eye)]
    seen = [sum(turn[i][j] * arm[i] for i in range(3)) for j in range(3)]
    focal = PICTURE[1] / 2 / math.tan(math.radians(fov) / 2)
    return PICTURE[0] / 2 - focal * seen[0] / seen[2], PICTURE[1] / 2 + focal * seen[1] / seen[2]


def hull(points):
    """Corners of the convex hull, in order."""
    points = sorted(points)
    chains = []
    for ordered in (points, points[::-1]):
        chain = []
        for p in ordered:
            while len(chain) > 1 and (chain[-1][0] - chain[-2][0]) * (p[1] - chain[-2][1]) <= (chain[-1][1] - chain[-2][1]) * (p[0] - chain[-2][0]):
                chain.pop()
            chain.append(p)
        chains += chain[:-1]
    return chains


def walls_polygon(text, height, width, depth):
    """Where the clear walls are in the picture: liquid that they keep is left behind on them, and looks like the block."""
    corners = [projected(text, (x, y, z)) for x in (-0.003, width + 0.0015) for y in (0, height + 0.003) for z in (-0.002, depth + 0.002)]
    return " ".join(f"{x:.0f},{y:.0f}" for x, y in hull(corners))


def dam_breaks():
    """Folder of the real dam breaks."""
    root = pathlib.Path(__file__).resolve().parents[2]
    data = root.parent / "shared" / "data" / "virheometry"
    if not data.is_dir():
        raise Unmeasured("needs ../shared/data/virheometry")
    return data


def prepare(context, name, folder):
    """Camera, masks and scene of a block in a folder; the time [s] of its last mask."""
    experiment = dam_breaks() / "experiments" / name
    height, width, depth, rungs = BLOCKS[name]
    folder.mkdir(parents=True, exist_ok=True)
    shutil.copy(experiment / "camera_params.xml", folder / "camera.xml")
    polygon = walls_polygon((experiment / "camera_params.xml").read_text(), height, width, depth)
    if not (folder / "masks").is_dir():
        execute(context, [built(context, "treacle"), "silhouettes", experiment, "--method", "masks", "--rate", 24, "--out", folder / "masks", "--no-overlay", "--set",
                          f'exclusions=[{{polygon: "{polygon}"}}]'])
    last = len(list(experiment.glob("config_*.png"))) / 24
    (folder / "scene.yaml").write_text(SCENE.format(spacing=rungs[0], width=width, height=height, depth=depth, behind=-0.013, before=depth + 0.013,
                                                    x_max=width + 0.17, y_max=height + 0.01, z_min=-0.06, z_max=depth + 0.06, end=last + 0.01))
    return last


def newtonian(context, name):
    """Viscosity [Pa s] by one parameter, that of the rheometer at the shear rate of the answer [1/s], the rate, misfit [px]."""
    data, treacle, rungs = dam_breaks(), built(context, "treacle"), BLOCKS[name][3]
    with scratch(context, name) as folder:
        last = prepare(context, name, folder)
        (folder / "study.yaml").write_text(STUDY.format(camera="camera.xml", zero=-1 / 24, last=last + 0.002,
                                                        rungs=", ".join(f"{one} mm" for one in (rungs[:2] if context.quick else rungs))))
        said = execute(context, [treacle, "identify", folder / "study.yaml", "--out", folder / "out", "--compare-curve", data / "rheometer" / CURVES[name.split("_")[0]]],
                       timeout=7200).output
        result = (folder / "out/report/result.yaml").read_text()
    rate, value, measured = map(float, re.search(r"at (\S+) 1/s (\S+) Pa s, measured (\S+) Pa s", said).groups())
    low, high = map(float, re.search(r"interval_90: \[(\S+) Pa.s, (\S+) Pa.s", result).groups())
    return value, low, high, measured, rate, float(re.search(r"px: (\S+)}", result).group(1))


def add_rows(table):
    @table.row("real dam breaks, Newtonian", claim="one viscosity against the rheometer's curve at the mean shear rate by dissipation and by what each frame tells of the viscosity",
               asked="within 15 % (public peers: 20 to 128 % of curves)")
    def real(context):
        texts, worst = [], 0
        for name in list(BLOCKS)[:1] if context.quick else BLOCKS:
            value, low, high, measured, rate, misfit = newtonian(context, name)
            worst = max(worst, abs(math.log(value / measured)))
            texts.append(f"{name}: {value:.3g} [{low:.3g}, {high:.3g}] Pa s at {rate:.3g} 1/s, measured {measured:.3g} ({100 * (value / measured - 1):+.0f} %), misfit {misfit:.1f} px")
        return Figure("; ".join(texts), worst <= math.log(1.15))
