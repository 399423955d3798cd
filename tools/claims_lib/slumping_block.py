"""Scene of the rows of `identify` that need no other: a plane block of syrup that slumps."""

SCENE = """schema_version: 1
title: A plane block of syrup slumps
domain: {dimensions: 2, max: [0.3, 0.12], spacing: 7 mm, boundaries: {y_min: {slip: no_slip}, y_max: open}}
liquids:
  - {name: syrup, density: 1400, viscosity: 10 Pa.s, shapes: [{box: {min: [0, 0], max: [0.06, 0.08]}}]}
method: grid
time: {end: END}
output: {interval: 16 ms}
cameras:
"""
FRONT = """  - {name: front, position: [0.13, 0.05, 0.6], target: [0.13, 0.05, 0], up: [0, 1, 0], width: 640, height: 360, field_of_view: 28 deg}
"""


def scene(end, cameras=FRONT):
    """The scene up to a time, "0.5 s", with its camera or others."""
    return SCENE.replace("END", end) + cameras
