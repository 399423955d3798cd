"""Rows of `seeing` on the step that solves pressure and viscosity together."""

from .gtest import run_gtest
from .run import RunFolder, scratch, treacle
from .table import Figure

NEVER = 10**6  # iterations of a solve that failed
PHASES = ("sort", "transfer", "surface", "pressure", "viscosity", "move", "correct")

# A ball of liquid over a pool in a box of walls.
SCENE = """schema_version: 1
domain: {{min: [0, 0, 0], max: [1, 1, 1], spacing: {spacing}}}
liquids:
  - name: liquid
    density: 1000
    viscosity: {viscosity}
    shapes: [{{sphere: {{centre: [0.5, 0.55, 0.45], radius: 0.25}}}}, {{box: {{min: [0, 0, 0], max: [1, 1, 0.12]}}}}]
method: {{kind: grid, grid: {{stokes: {{solve: {solve}}}}}}}
time: {{end: 1, rule: fixed, step: 0.01}}
output: {{interval: 10}}
"""


def flows(context, names, asked):
    """Tests whose figures lie within the requirement."""
    report = run_gtest(context, "grid_stokes_flows_test", ":".join(f"StokesFlows.{name}" for name in names))
    return Figure(report.text(), report.ok and report.ran == asked)


def hanging_column(context):
    return flows(context, ["AHangingColumnStretchesByItsExtensionalViscosity"], 1)


def levelling_waves_drops(context):
    found = flows(context, ["AViscousLayerLevels", "AStandingWaveSwingsAndDiesDown"], 2)
    drops = run_gtest(context, "grid_tension_test", "Drops.OscillateAtTheirFrequency")
    return Figure(f"{found.measured}; drops: {drops.text()}", found.ok and drops.ok)


def variable_viscosity(context):
    return flows(context, ["AJumpOfViscosityIsSecondOrder", "AnExponentialViscosityIsSecondOrder"], 2)


def run_steps(context, cells, viscosity, solve, count):
    """Seconds of phases and iterations of a few steps, all but the first, which starts from nothing."""
    with scratch(context, "stokes") as folder:
        scene = folder / "scene.yaml"
        scene.write_text(SCENE.format(spacing=1 / cells, viscosity=viscosity, solve=solve))
        treacle(context, "run", scene, "--out", folder / "out", "--set", f"time.end={count * 0.01 - 0.005}", expect=None,
                timeout=4 * 3600)
        columns = RunFolder(folder / "out").steps()
        return {name: columns[name] for name in (*PHASES, "stokes iterations")}


def cost(context):
    """Seconds of whole steps; iterations as the grid grows."""
    cells, count = (48, 3) if context.quick else (96, 4)
    whole = {}
    for solve in ("split", "together"):
        found = run_steps(context, cells, 1000, solve, count)
        whole[solve] = sum(found[phase][1:].sum() for phase in PHASES)
    ratio = whole["together"] / whole["split"]
    most = {}
    for size in (24, 48) if context.quick else (48, 96, 192):
        for stiffness in (1, 1e3, 1e6):
            viscosity = stiffness * 1000 / (0.01 * size * size)
            found = run_steps(context, size, viscosity, "together", 2)["stokes iterations"]
            most.setdefault(size, []).append(int(found[1:].max()) if len(found) > 1 else NEVER)
    sizes = sorted(most)
    growth = max(last / first for first, last in zip(most[sizes[0]], most[sizes[-1]]))
    spread = max(max(values) / min(values) for values in most.values())
    text = f"{cells}^3: {ratio:.2f} times the split step; iterations at nu dt/dx^2 of 1, 1e3, 1e6: " + ", ".join(
        f"{size}^3 {values}" for size, values in most.items()) + f"; growth {growth:.2f}, over the stiffness {spread:.2f}"
    return Figure(text, ratio <= 1.5 and growth <= 1.3 and spread <= 1.3)


def add_rows(table):
    table.row("hanging column", claim="Trouton, 2D of 4 and 8 cells, 3D of 4 cells wide; pressure and viscosity together, and one after the other",
              asked="1 +- 0.03; 2.0 +- 0.05 and 1.5 +- 0.05 as the negative control")(hanging_column)
    table.row("levelling, wave, drop", claim="Orchard's rate, a damped standing wave, drops that oscillate",
              asked="+- 10 %; frequency +- 2 %, rate +- 10 %; frequency +- 4 %")(levelling_waves_drops)
    table.row("variable viscosity", claim="SolCx with a jump of 1e6 and SolKz, three resolutions",
              asked="second order in velocity, first in pressure")(variable_viscosity)
    table.row("unified step", claim="cost beside the split step at 96^3, iterations from 48^3 to 192^3 and over nu dt/dx^2 from 1 to 1e6",
              asked="<= 1.5 times; growing <= 1.3 times")(cost)
