"""Rows of `sph` where there is no free surface: cavities, channels, liquid between solids, interfaces, inlets."""

import dataclasses
import itertools
import math

import numpy

from .sph_runs import crossings, judged, on_ranks, over_cases, profile, scene_run
from .table import Figure
from .viscous_walls import start_up

CAVITY = """
schema_version: 1
title: Lid-driven cavity
domain:
  dimensions: 2
  max: [1, 1.125]
  spacing: {spacing}
  gravity: [0, 0]
  boundaries: {{x_min: {{slip: no_slip}}, x_max: {{slip: no_slip}}, y_min: {{slip: no_slip}}, y_max: {{slip: no_slip}}}}
liquids:
  - {{name: liquid, density: 1000, viscosity: {viscosity}, {rheology}shapes: [{{box: {{min: [0, 0], max: [1, 1]}}}}]}}
bodies:
  - {{name: lid, kind: kinematic, slip: no_slip, velocity: [1, 0], shape: {{box: {{min: [-60, 1], max: [2, 1.5]}}}}}}
method: {{kind: sph, kernel: {kernel}}}
time: {{end: {end}}}
output: {{interval: 0.5}}
"""

# u_min on x = 1/2, v_max and v_min on y = 1/2, of Ghia, Ghia & Shin (1982).
GHIA = {100: (-0.21090, 0.17527, -0.24533), 1000: (-0.38289, 0.37095, -0.51550)}
KERNELS = ("cubic_spline", "wendland_c2")
THINNING = "rheology: {law: power_law, exponent: 0.7}, "

CHANNEL = """
schema_version: 1
title: A full channel
domain:
  dimensions: 2
  min: [0, -0.1]
  max: [{length}, 0.1]
  spacing: {spacing}
  gravity: [{pull}, 0]
  boundaries: {{x_min: periodic, x_max: periodic, y_min: {{slip: no_slip}}, y_max: {{slip: no_slip}}}}
liquids:
{liquids}
method: {{kind: sph, kernel: {kernel}}}
time: {{end: {end}}}
output: {{interval: {interval}, double_precision: true}}
"""

ONE = "  - {{name: l, density: 1000, viscosity: {viscosity}, {rheology}shapes: [{{box: {{min: [0, -0.1], max: [{length}, 0.1]}}}}]}}"
TWO = """  - {name: thick, density: 1000, viscosity: 10000 Pa.s, shapes: [{box: {min: [0, -0.1], max: [0.05, 0]}}]}
  - {name: thin, density: 1000, viscosity: 10 Pa.s, shapes: [{box: {min: [0, 0], max: [0.05, 0.1]}}]}"""

OFF_LATTICE = """
schema_version: 1
title: Oil between plates off the lattice
domain: {{dimensions: 2, min: [0, -0.05], max: [0.4, 0.16], spacing: 5 mm, gravity: [10, 0], boundaries: {{x_min: periodic, x_max: periodic}}}}
liquids: [{{name: oil, density: 1000, viscosity: 100, subtract_bodies: true, shapes: [{{box: {{min: [0, -0.04], max: [0.4, 0.15]}}}}]}}]
bodies:
  - {{name: low, slip: no_slip, shape: {{plane: {{point: [0, {low}], normal: [0, 1]}}}}}}
  - {{name: high, slip: no_slip, shape: {{plane: {{point: [0, {high}], normal: [0, -1]}}}}}}
time: {{end: 0.1, rule: fixed, step: 2 ms}}
output: {{interval: 0.05}}
"""

CUP = """
schema_version: 1
title: A rotor turns in a cup
method: {{kind: sph}}
domain: {{dimensions: {dimensions}, min: {low}, max: {high}, spacing: {spacing}, gravity: {gravity}}}
liquids: [{{name: oil, density: 1000, viscosity: 100, shapes: [{{box: {{min: {low}, max: {high}}}}}], subtract_bodies: true}}]
bodies:
  - {{name: cup, slip: no_slip, shape: {{sphere: {{centre: {centre}, radius: 0.2, inverted: true}}}}}}
  - {{name: rotor, slip: no_slip, kind: kinematic, angular_velocity: [0, 0, 1], shape: {{sphere: {{centre: {centre}, radius: 0.1}}}}}}
time: {{end: {end}, rule: fixed, step: 2 ms}}
output: {{interval: 0}}
"""

INLET = """
schema_version: 1
title: An inlet pushes liquid at rest
domain: {dimensions: 2, max: [0.6, 0.2], spacing: 1 cm, gravity: [0, 0], boundaries: {x_min: open, x_max: open}}
liquids:
  - {name: w, density: 1000, viscosity: 1 Pa.s, shapes: [{box: {min: [0.1, 0], max: [0.6, 0.2]}}]}
inlets:
  - {name: in, rectangle: {centre: [0.1, 0.1], direction: [1, 0], width: 0.2, height: 0}, velocity: 0.2 m/s}
outlets:
  - {name: out, half_space: {point: [0.5, 0], normal: [-1, 0]}}
method: {kind: sph}
time: {end: 2 s}
output: {interval: 0.2 s}
"""

DISC = """
schema_version: 1
title: A disc pours
domain:
  min: [-0.05, -0.05, -0.2]
  max: [0.05, 0.05, 0.05]
  spacing: {spacing}
  gravity: [0, 0, 0]
  boundaries: {{x_min: open, x_max: open, y_min: open, y_max: open, z_min: open, z_max: open}}
liquids: [{{name: syrup, density: 1000, viscosity: 1}}]
inlets: [{{disc: {{centre: [{off}, 0, 0], direction: {direction}, radius: {radius}}}, velocity: 0.2}}]
method: {{kind: sph}}
time: {{end: 0.5}}
output: {{interval: 0}}
"""

BASIN = """
schema_version: 1
title: A basin under an inlet that waits
domain: {{dimensions: 2, max: [0.6, 1.2], spacing: 2 cm}}
liquids: [{{name: w, density: 1000, viscosity: 1 Pa.s, shapes: [{{box: {{min: [0, 0], max: [0.6, 0.8]}}}}]}}]
inlets: [{{rectangle: {{centre: [0.3, {centre}], direction: [0, -1], width: {width}, height: 0}}, velocity: 0.1}}]
method: {{kind: sph}}
time: {{end: 0.02}}
output: {{interval: 0}}
measurements: [{{name: height, kind: height, axis: y, position: [0.31, 0]}}]
"""

WAVE = """
schema_version: 1
title: A wave between two liquids
domain: {{dimensions: 2, max: [1, 0.5], spacing: {spacing}}}
liquids:
  - {{name: heavy, density: 3000, shapes: [{heavy}]}}
  - {{name: light, density: 1000, shapes: [{light}]}}
method: {{kind: sph}}
time: {{end: 2.4}}
output: {{interval: 0.04, fields: [velocity, liquid]}}
"""


def cavity_scene(number, across, *, kernel="cubic_spline", rheology="", end):
    return CAVITY.format(spacing=1 / across, viscosity=1000 / number, kernel=kernel, rheology=rheology, end=end)


def ghia(run, number, across):
    """Extremes on the middle lines, means of the last outputs, beside the table's: text and worst deviation."""
    rows, spacing = [], 1 / across
    places = numpy.linspace(0.02, 0.98, 193)
    upright, lying = [(0.5, y) for y in places], [(x, 0.5) for x in places]
    for index in range(-min(4, len(run.frames())), 0):
        frame = run.frame(index)
        u, v = profile(frame, (0, 1), 0, spacing, upright), profile(frame, (0, 1), 1, spacing, lying)
        rows.append((numpy.nanmin(u), numpy.nanmax(v), numpy.nanmin(v)))
    found = numpy.mean(rows, axis=0)
    worst = float(numpy.abs(found / numpy.array(GHIA[number]) - 1).max())
    return f"u_min {found[0]:.3f}, v_max {found[1]:.3f}, v_min {found[2]:.3f} at {run.frames()[-1][0]:.1f} s", worst


def cavity(context):
    """The scene until it is steady; it is to get to 2 s first of all."""
    def judge(run):
        text, worst = ghia(run, 100, 64)
        return f"{text}, within {100 * worst:.1f} %", worst <= 0.05

    return on_ranks(context, cavity_scene(100, 64, end=15), "cavity", judge)


def cavities_converge(context):
    """With --quick Reynolds' number 100 alone."""
    parts, right = [], True
    for number, sizes, end in ((100, (16, 32, 64), 15), (1000, (32, 64, 128), 50))[:context.pick(2, 1, 1)]:
        errors = []
        for across in sizes:
            with scene_run(context, cavity_scene(number, across, end=end), "cavity") as (run, fault):
                words, ended = judged(run, fault, lambda run: (errors.append(ghia(run, number, across)[1]) or f"{100 * errors[-1]:.1f} %", True))
            right = right and ended
            parts.append(f"Re {number}, 1/{across}: {words}")
        right = right and len(errors) == 3 and errors == sorted(errors, reverse=True) and errors[-1] <= 0.05
    return Figure("; ".join(parts), right)


def runs_on(run, _):
    steps = run.steps()
    kept = steps["particles"][-1] == steps["particles"][0]
    return (f"to {steps['time'][-1]:.2f} s, fastest {steps['max speed'].max():.3g} m/s, {'all' if kept else 'NOT all'} kept",
            kept and steps["max speed"].max() <= 1.05)


def cavities_run(context):
    cases = list(itertools.product((1, 10, 100, 1000), (16, 32, 64), KERNELS, ("", THINNING)))
    cases = context.sample([case for case in cases if case[1] < 64 or not context.quick], 4)
    return over_cases(context, cases, "cavity", lambda case: cavity_scene(case[0], case[1], kernel=case[2], rheology=case[3], end=2), runs_on,
                      lambda case: f"Re {case[0]}, 1/{case[1]}, {case[2]}, {'thinning' if case[3] else 'Newtonian'}")


def channel_scene(across, *, liquids=None, viscosity=6, rheology="", pull=10, kernel="cubic_spline", end, interval):
    length = 0.05 if across >= 40 else 0.1
    liquids = liquids or ONE.format(viscosity=viscosity, rheology=rheology, length=length)
    return CHANNEL.format(spacing=0.2 / across, length=length, pull=pull, liquids=liquids, kernel=kernel, end=end, interval=interval)


def middle(frame, places=(0.0,), spacing=0.005):
    """Velocity along x at heights, by a fit over the particles about each: the channel is the same all along."""
    return profile(frame, (1,), 0, spacing, [(place,) for place in places])


def channel(context):
    """u_max at 1 s, and once it is steady."""
    exact = start_up(numpy.array([0.1]), 1.0, 0.006, 0.1, 10)[0]

    def judge(run):
        frames = run.frames()
        early = [number for number, (time, _) in enumerate(frames) if abs(time - 1) < 1e-6]
        found = [float(middle(run.frame(number))[0]) for number in (*early, -1)]
        text = ", ".join(f"{one:.2f} at {time:.2f} s" for one, time in zip(found, [1.0] * len(early) + [frames[-1][0]]))
        return (f"u_max {text}; {exact:.2f} at 1 s and 8.33 m/s at 5 s",
                len(found) == 2 and abs(found[0] / exact - 1) <= 0.02 and abs(found[1] / 8.333 - 1) <= 0.02 and frames[-1][0] > 4.9)

    return on_ranks(context, channel_scene(40, end=5, interval=0.5), "channel", judge)


@dataclasses.dataclass(frozen=True)
class Start:
    """A channel that starts up, by its mean velocity and width."""

    number: float # Re
    across: int   # particles
    kernel: str

    def text(self):
        return f"Re {self.number}, {self.across} across, {self.kernel}"

    def nu(self):
        """u_max = g h^2 / (2 nu), Re = (2/3) u_max 2 h / nu."""
        return math.sqrt(10 * 0.1**3 * 2 / (3 * self.number))

    def end(self):
        return min(3 * 0.1**2 / self.nu(), 4.0)

    def scene(self):
        return channel_scene(self.across, viscosity=1000 * self.nu(), kernel=self.kernel, end=self.end(), interval=self.end())

    def judge(self, run):
        places = numpy.linspace(-0.08, 0.08, 17)
        exact = start_up(0.1 - numpy.abs(places), self.end(), self.nu(), 0.1, 10)
        error = float(numpy.abs(middle(run.frame(-1), places, 0.2 / self.across) - exact).max() / exact.max())
        return f"within {100 * error:.2f} %", error <= {20: 0.04, 40: 0.02, 80: 0.01}[self.across]


def channels(context):
    cases = [Start(*case) for case in itertools.product((1, 10, 100, 1000), context.pick((20, 40, 80), (20, 40), (20,)), KERNELS)]
    return over_cases(context, context.sample(cases, 3), "channel", Start.scene, lambda run, case: case.judge(run), Start.text)


def plugs(context):
    """Bingham and Herschel-Bulkley: the yield stress is three tenths of the wall's stress."""
    parts, right = [], True
    for name, exponent, consistency, end in (("Bingham", 1, 19.6, 3), ("Herschel-Bulkley", 0.5, 95.64, 3)):
        rheology = f"rheology: {{law: herschel_bulkley, exponent: {exponent}, yield_stress: 300, regularisation_time: 100}}, "
        power = 1 + 1 / exponent
        exact = (1e4 / consistency) ** (1 / exponent) / power * 0.07**power
        text = channel_scene(40, viscosity=consistency, rheology=rheology, end=end, interval=0.25)
        with scene_run(context, text, "plug") as (run, fault):
            def judge(run):
                found = float(middle(run.frame(-1))[0])
                return f"{100 * (found / exact - 1):+.1f} % at {run.frames()[-1][0]:.2f} s", abs(found / exact - 1) <= 0.02

            words, ok = judged(run, fault, judge)
        parts.append(f"{name} {words}")
        right = right and ok
    return Figure("; ".join(parts), right)


def viscosity_interface(context):
    def judge(run):
        frame = run.frame(-1)
        places = numpy.linspace(0.0025, 0.0975, 20)
        found = middle(frame, places)
        return (f"u_max {found.max():.3f} m/s, {float(numpy.interp(0.005, places, found)):.3f} one spacing above the interface",
                abs(found.max() / 1.253 - 1) <= 0.02)

    return on_ranks(context, channel_scene(40, liquids=TWO, end=3, interval=1), "interface", judge)


def inlet_into_liquid_at_rest(context):
    def judge(run):
        means, fastest, stored = [], 0.0, []
        for number, _ in enumerate(run.frames()):
            if number == 0:
                continue
            frame = run.frame(number)
            x, u = frame["position"][:, 0], frame["velocity"][:, 0]
            inside = (x > 0.1) & (x < 0.5)
            stored.append(int(inside.sum()))
            means.append(float(u[inside].mean()))
            fastest = max(fastest, float(numpy.linalg.norm(frame["velocity"][inside], axis=1).max()))
        if not means:
            return "no output", False
        return (f"{min(means):.3f} .. {max(means):.3f} m/s, fastest {fastest:.2f}, {min(stored)} .. {max(stored)} of 800 particles stored",
                max(abs(one / 0.2 - 1) for one in means) <= 0.02 and fastest <= 0.25 and all(abs(one - 800) <= 20 for one in stored))

    return on_ranks(context, INLET, "inlet", judge)


def channel_off_lattice(context):
    def judge(run):
        steps = run.steps()
        mean, mass = float(steps["momentum x"][-1] / steps["mass"][-1]), float(steps["mass"][0])
        return f"{mean:.4f} of 0.0833 m/s, {mass:.2f} of 40 kg/m", abs(mean / 0.083333 - 1) <= 0.03 and abs(mass / 40 - 1) <= 0.005

    return on_ranks(context, OFF_LATTICE.format(low=0.0012, high=0.1012), "plates", judge)


def cup_scene(dimensions, spacing, centre, end):
    half = 0.25
    return CUP.format(dimensions=dimensions, low=[-half] * dimensions, high=[half] * dimensions, spacing=spacing, gravity=[0] * dimensions,
                      centre=list(centre), end=end)


def cup_torque(context):
    def judge(run):
        bodies, mass = run.bodies(), float(run.steps()["mass"][0])
        late = bodies["time"] > 0.3
        torque = -float(sum(bodies[f"rotor {kind} torque z"][late].mean() for kind in ("viscous", "pressure")))
        exact = 1000 * math.pi * (0.2**2 - 0.1**2)
        return (f"torque {torque:.2f} of 16.755 N, {mass:.2f} of {exact:.2f} kg/m",
                abs(torque / 16.755 - 1) <= 0.03 and abs(mass / exact - 1) <= 0.005)

    return on_ranks(context, cup_scene(2, 0.005, (0, 0), 0.4), "cup", judge)


def seeded(row):
    """Scene of a step of liquid between solids, and its mass [kg], in the plane [kg/m]."""
    kind, offset, size = row
    if kind == "plates":
        return OFF_LATTICE.format(low=offset, high=offset + size).replace("end: 0.1,", "end: 0.002,"), 1000 * 0.4 * size
    dimensions = 2 if kind == "cup" else 3
    volume = math.pi * (0.2**2 - 0.1**2) if kind == "cup" else 4 / 3 * math.pi * (0.2**3 - 0.1**3)
    return cup_scene(dimensions, size, [offset, 0.6 * offset, 0.3 * offset][:dimensions], 0.002), 1000 * volume


def filled(run, row):
    error = float(run.steps()["mass"][0]) / seeded(row)[1] - 1
    return f"{100 * error:+.2f} %", abs(error) <= 0.005


def seeding(context):
    rows = list(itertools.product(("plates",), (0, 0.0007, 0.0012, 0.0025, 0.0031, 0.0044), (0.1, 0.0977, 0.0513, 0.0212)))
    rows += itertools.product(("cup",), (0, 0.0013, 0.0037), (0.01, 0.005, 0.0071))
    rows += itertools.product(("ball",), (0, 0.0051, 0.0083), (0.02,))
    return over_cases(context, context.sample(rows, 6), "seeding", lambda row: seeded(row)[0], filled,
                      lambda row: f"{row[0]} off by {row[1]}, {row[2]}")


def poured(run, row):
    """Volume by time: layers arrive one by one."""
    radius, spacing = row[:2]
    steps = run.steps()
    rate = numpy.polyfit(steps["time"], steps["flowed in"], 1)[0] * spacing**3
    error = rate / (math.pi * radius**2 * 0.2) - 1
    return f"{100 * error:+.2f} %", abs(error) <= 0.01


def disc_rate(context):
    rows = itertools.product((0.01, 0.02), (0.0025, 0.004), (0, 0.0011), ("[0, 0, -1]", "[0.1, 0.05, -1]"))
    return over_cases(context, context.sample(rows, 3), "disc",
                      lambda row: DISC.format(radius=row[0], spacing=row[1], off=row[2], direction=row[3]), poured,
                      lambda row: f"radius {row[0]}, spacing {row[1]}, off by {row[2]}, {row[3]}")


def seen_height(run, _):
    """Before anything has fallen."""
    height = float(run.measurements()["height"][0])
    return f"height {height:.3f} m", abs(height - 0.8) <= 0.02


def waiting_layers(context):
    """Liquid 0.8 m deep, and an inlet at it or above it, behind which there are buffer layers."""
    rows = context.sample(itertools.product((0.8, 0.86, 0.96), (0.1, 0.3, 0.6)), 3)
    return over_cases(context, rows, "basin", lambda row: BASIN.format(centre=row[0], width=row[1]), seen_height,
                      lambda row: f"inlet at {row[0]} m, {row[1]} wide")


def wave_scene(spacing):
    """An interface at 0.25 + 0.05 cos(pi x): a column of each liquid for each column of particles."""
    heavy, light = [], []
    for column in range(round(1 / spacing)):
        low, high = column * spacing, (column + 1) * spacing
        top = spacing * round((0.25 + 0.05 * math.cos(math.pi * (low + high) / 2)) / spacing)
        heavy.append(f"{{box: {{min: [{low:.6f}, 0], max: [{high:.6f}, {top:.6f}]}}}}")
        light.append(f"{{box: {{min: [{low:.6f}, {top:.6f}], max: [{high:.6f}, 0.5]}}}}")
    return WAVE.format(spacing=spacing, heavy=", ".join(heavy), light=", ".join(light))


def interfacial_wave(context):
    """Half a period, by where the first mode's amplitude passes zero, and what is left of it when it has swung over."""
    depth = 1 / math.tanh(math.pi * 0.25)
    half = math.pi / math.sqrt(9.81 * math.pi * 2000 / (3000 * depth + 1000 * depth))

    def judge(run):
        time, mode = [], []
        for number, (at, _) in enumerate(run.frames()):
            frame = run.frame(number)
            time.append(at)
            mode.append(float(numpy.cos(math.pi * frame["position"][frame["liquid"] == 0, 0]).sum()))
        time, mode = numpy.array(time), numpy.array(mode) / mode[0]
        passed = crossings(time, mode)
        if len(passed) < 2:
            return f"{len(passed)} passages in {time[-1]:.2f} s, the mode's amplitude from 1 to {mode[-1]:.2f}", False
        found, left = passed[1] - passed[0], -float(mode.min())
        return (f"period {100 * (found / half - 1):+.1f} %, amplitude {100 * (left - 1):+.0f} % after half a period",
                abs(found / half - 1) <= 0.03 and left >= 0.95)

    return on_ranks(context, wave_scene(context.pick(0.0125, 0.02, 0.02)), "wave", judge)


def add_rows(table):
    table.row("cavity_sph", claim="lid-driven cavity, Re 100, 1/64, until it is steady; 1, 2, 3 ranks",
              asked="u_min -.211, v_max .175, v_min -.245 (Ghia et al. 1982) within 5 %")(cavity)
    table.row("cavities converge", claim="Re 100 at 1/16, 1/32, 1/64, Re 1000 at 1/32, 1/64, 1/128",
              asked="to Ghia's table; within 5 % at the finest")(cavities_converge)
    table.row("cavities run", claim="Re 1 to 1000, three spacings, both kernels, Newtonian and thinning, 2 s, 1 to 3 ranks",
              asked="run, keep all, nothing faster than the lid by 5 %")(cavities_run)
    table.row("channel_sph", claim="a full periodic channel, Re 180, 40 across, 5 s; 1, 2, 3 ranks",
              asked="u_max 6.37 m/s at 1 s and 8.33 steady, within 2 %")(channel)
    table.row("channels", claim="Re 1 to 1000, 20, 40, 80 across, both kernels, 1 to 3 ranks", asked="start-up within 4, 2, 1 %")(channels)
    table.row("plugs", claim="Bingham and Herschel-Bulkley in a channel 40 across", asked="plug's speed within 2 %")(plugs)
    table.row("viscosity_interface", claim="two layers in a channel, viscosities 1000 : 1; 1, 2, 3 ranks", asked="u_max 1.253 m/s within 2 %")(
        viscosity_interface)
    table.row("interfacial wave", claim="inviscid, density 3 : 1, in a closed tank, default options; 1, 2, 3 ranks",
              asked="period within 3 %, amplitude loss <= 5 % a half period")(interfacial_wave)
    table.row("seeding", claim="plates, cups and balls at offsets within a spacing", asked="volume within 0.5 %")(seeding)
    table.row("channel_off_lattice", claim="a channel whose walls are off the lattice; 1, 2, 3 ranks",
              asked="mean speed 0.0833 m/s within 3 %, volume 0.5 %")(channel_off_lattice)
    table.row("cup_torque_sph", claim="a rotor in a cup, 5 mm; 1, 2, 3 ranks", asked="16.755 N within 3 %, volume 0.5 %")(cup_torque)
    table.row("inlet_into_liquid_at_rest_sph", claim="an inlet at 0.2 m/s pushes liquid at rest; 1, 2, 3 ranks",
              asked="0.2 m/s within 2 %, nothing above 0.25; 800 particles stay stored, a column more or less")(inlet_into_liquid_at_rest)
    table.row("disc inlet", claim="round inlets of 2.5 to 8 spacings a radius, on and off the lattice, upright and oblique, 1 to 3 ranks",
              asked="the flow rate within 1 %")(disc_rate)
    table.row("waiting layers", claim="measured height of 0.8 m of liquid below inlets, 1 to 3 ranks", asked="0.8 m within a spacing")(waiting_layers)
