"""Rows of `ground`: hybrid incompressible SPH from a scene file to a picture, on any number of ranks."""

import os

import numpy

from . import dam_breaks, frame_readers, identity
from .bench import bench, better
from .gtest import run_gtest
from .run import Columns, resume, run_scene, scratch
from .table import CommandFailed, Figure, Table

TABLE = Table("ground")
INPUTS = "inputs"


def scene(context, name):
    return context.root / INPUTS / name / "scene.yaml"


@TABLE.row("golden numbers", claim="kernel sums on a lattice and at a single-layer wall are the reference's",
           asked="4 digits")
def golden_numbers(context):
    names = ["Lattice.*", "PlanarWall.*", "Densities.OfASquareLatticeAtAWallAreTheGoldenNumbers",
             "SolidTerms.TwoParticlesOnASolidHaveTheirClosedFormPressures"]
    report = run_gtest(context, "sph_formulas_test", ":".join(names))
    return Figure(f"{report.text()}: 9 lattices, 5 gaps to a wall in space, 4 in the plane; half of the last "
                  "digit given, but for the wall term alpha of the reference, within 0.002", report.ok)


COLUMN_WIDTH, SPACING = 0.24, 0.02  # of the hydrostatic column [m]
DENSITY, GRAVITY = 1000.0, 9.81
SETTLED = 0.5  # [s]


def pressure_slope(frame):
    """Of the pressure over the depth in the bulk, in rho g."""
    x, p = frame["position"], frame["pressure"]
    top = x[:, 1].max()
    bulk = ((x[:, 0] > 3 * SPACING) & (x[:, 0] < COLUMN_WIDTH - 3 * SPACING) & (x[:, 1] > 0.2 * top)
            & (x[:, 1] < 0.8 * top))
    if bulk.sum() < 50:
        raise CommandFailed(f"only {bulk.sum()} particles in the bulk of the column")
    return -numpy.polyfit(x[bulk, 1], p[bulk], 1)[0] / (DENSITY * GRAVITY)


@TABLE.row("hydrostatic column", claim="water at rest has the pressure of its depth, its weight on the floor, no motion",
           asked="bulk slope 1 ± 0.03, wall force = weight ± 1 %, maximum speed < 0.05 m/s after 0.5 s")
def hydrostatic_column(context):
    with scratch(context, "column") as folder:
        run = run_scene(context, scene(context, "hydrostatic_column"), folder / "run",
                        set={"time.end": 1, "output.interval": 0.02})
        frames = [number for number, (time, _) in enumerate(run.frames()) if time > SETTLED]
        slope = float(numpy.mean([pressure_slope(run.frame(number)) for number in frames]))
        steps, bodies = run.steps(), run.bodies()
        late = bodies["time"] > SETTLED
        sides = [name for name in bodies.names() if name.endswith("pressure force y")]
        force = -sum(float(bodies[name][late].mean()) for name in sides) / (steps["mass"][-1] * GRAVITY)
        speed = float(steps["max speed"][steps["time"] > SETTLED].max())
    ok = abs(slope - 1) <= 0.03 and abs(force - 1) <= 0.01 and speed < 0.05
    return Figure(f"slope {slope:.4f} (mean of {len(frames)} frames), force {force:.4f} weights, "
                  f"at most {speed:.4f} m/s", ok)


@TABLE.row("Martin & Moyce", claim="front and residual height of the column of Martin and Moyce (V3, V3b)",
           asked="front ± 8 % after a shift of T of at most 0.15, up to T = 4.03; height ± 6 %")
def martin_moyce(context):
    width = dam_breaks.MARTIN_MOYCE_WIDTH
    with scratch(context, "martin_moyce") as folder:
        run = run_scene(context, scene(context, "martin_moyce"), folder / "run",
                        set={"time.end": 0.405, "output.interval": 0})
        values = run.measurements()
        time, front, height = values["time"], values["front"] / width, values["height"] / (2 * width)
    return dam_breaks.martin_moyce(time, front, height, front_within=0.08, height_within=0.06)


@TABLE.row("Koshizuka & Oka", claim="front of the column of Koshizuka and Oka (V3c)", asked="± 6 %")
def koshizuka_oka(context):
    width = dam_breaks.KOSHIZUKA_OKA_WIDTH
    with scratch(context, "koshizuka_oka") as folder:
        run = run_scene(context, scene(context, "koshizuka_oka"), folder / "run",
                        set={"time.end": 0.3, "output.interval": 0})
        values = run.measurements()
        time, front = values["time"], values["front"] / width
    return dam_breaks.koshizuka_oka(time, front, within=0.06)


# How many systems each test builds.
SYSTEMS = {
    "PressureMatrix.OfAJitteredBlockWithOneDirichletParticleIsPositiveDefinite": 1,
    "PressureMatrix.WithoutAnchorsHasOneNullVectorPerComponent": 1,
    "PressureMatrix.OfCompressedBlobsInFreeFlightIsPositiveDefinite": 5,
    "PressureMatrix.OfLiquidAroundAFloatingBodyIsPositiveDefiniteWithEverySolidTerm": 10,
    "PressureMatrix.OfIsolatedPairsIsPositiveDefinite": 5,
    "PressureMatrix.ATankWithoutAFreeSurfaceIsPositiveDefinite": 5,
}


@TABLE.row("pressure matrix", claim="symmetric, and positive definite with floating solids and blobs in free flight",
           asked="bitwise symmetric; positive definite in every configuration tried")
def pressure_matrix(context):
    definite = run_gtest(context, "sph_formulas_test", ":".join(SYSTEMS))
    several = [run_gtest(context, "sph_ranks_test", "*IsSymmetricBitForBit*:PressurePinning.*", ranks=ranks)
               for ranks in (1, 2, 3, 4)]
    ok = definite.ran == len(SYSTEMS) and all(report.ok for report in [definite, *several])
    runs = []
    for name in ("blobs", "hanging_ball"):
        with scratch(context, name) as folder:
            # Conjugate gradients that meet a direction of no or negative curvature end the run with exit code 3.
            run = run_scene(context, scene(context, name), folder / "run", expect=None,
                            set={"output.interval": 0, **({"time.end": 0.15} if context.quick else {})})
            ok = ok and run.finished.code == 0
            steps = len(run.steps())
            runs.append(f"{name} {steps} steps, exit code {run.finished.code}")
    return Figure(f"eigenvalues of {sum(SYSTEMS.values())} systems: {definite.text()}; symmetry bit for bit and "
                  f"anchors on 1, 2, 3, 4 ranks: {', '.join(report.text() for report in several)}; "
                  f"solved at every step: {'; '.join(runs)}", ok)


@TABLE.row("momentum", claim="pressure and viscosity of the liquid cancel; solids get what the liquid loses",
           asked="Σ m a = 0 to 1e-12 without solids; fluid + solid reaction to 1e-12")
def momentum(context):
    counts = (1, 2, 3, 4, 8)
    reports = [run_gtest(context, "sph_ranks_test", "Momentum.*", ranks=ranks) for ranks in counts]
    return Figure("relative to the sum of the sizes; on " + "; ".join(
        f"{ranks} ranks {report.text()}" for ranks, report in zip(counts, reports)),
        all(report.ok for report in reports))


@TABLE.row("numbers of ranks", claim="the same scene on 1, 2, 3, 4, 8 ranks",
           asked="positions after 50 steps agree to 1e-6 d; roles differ only within round-off of their threshold; "
                 "bitwise equal when repeated")
def numbers_of_ranks(context):
    with scratch(context, "ranks") as folder:
        def run(ranks, name):
            return run_scene(context, scene(context, "dam_break"), folder / name, ranks=ranks,
                             set=identity.overrides(context))

        alone = run(1, "1")
        one, start = alone.frame(), alone.frame(0)
        others = {ranks: run(ranks, str(ranks)).frame() for ranks in (2, 3, 4, 8)}
        again = run(2, "again").frame()
    moves = {ranks: identity.largest_move(one, frame) / identity.spacing(context) for ranks, frame in others.items()}
    roles = {ranks: identity.differing_roles(one, frame) for ranks, frame in others.items()}
    same = identity.bitwise_equal(others[2], again)
    # Round-off of 1e-12 decides on a particle in a million; ten times that is no accident.
    ok = max(moves.values()) <= 1e-6 and max(roles.values()) <= max(1, 1e-5 * len(one["id"])) and same
    text = ", ".join(f"{ranks}: {moves[ranks]:.1e} d and {roles[ranks]} roles" for ranks in others)
    gone = identity.largest_move(start, one) / identity.spacing(context)
    return Figure(f"{len(one['id'])} particles, {identity.STEPS} steps in which they move by up to {gone:.1f} d, "
                  f"against 1 rank on {text}; "
                  f"repeated on 2 ranks {'equal bit for bit' if same else 'DIFFERENT'}", ok)


def resumed(context, folder, written, read, damage):
    """Straight run against one that is resumed at half; returns the largest move [m] and what was printed."""
    half = identity.STEPS * identity.STEP / 2
    path = folder / f"{written}_{read}_{damage.__name__}"
    run = run_scene(context, scene(context, "dam_break"), path, ranks=written, set=identity.overrides(
        context, **{"output.checkpoint_interval": half / 2, "output.checkpoints_kept": 4}))
    straight = run.frame()
    # What a run that was cut off at half would not have.
    damage(sorted((path / "checkpoints").iterdir()))
    run.frames()[-1][1].unlink()
    after = resume(context, path, ranks=read)
    if after.steps()["step"].tolist() != list(range(1, identity.STEPS + 1)):
        raise CommandFailed(f"{path}: steps.csv does not hold every step once")
    return identity.largest_move(straight, after.frame()), after.finished.output


def remove_newest(checkpoints):
    for path in checkpoints[-2:]:
        path.unlink()


def truncate_newest(checkpoints):
    for path in checkpoints[-1:]:
        os.truncate(path, path.stat().st_size // 2)


@TABLE.row("resuming", claim="straight run = checkpoint + resume",
           asked="to 1e-12 on the same number of ranks, to 1e-6 d on another; a truncated newest checkpoint is "
                 "skipped with a message")
def resuming(context):
    with scratch(context, "resume") as folder:
        same = {ranks: resumed(context, folder, ranks, ranks, remove_newest)[0] for ranks in (1, 2, 3)}
        other = {pair: resumed(context, folder, *pair, remove_newest)[0] / identity.spacing(context)
                 for pair in ((2, 1), (1, 2), (2, 4))}
        cut, output = resumed(context, folder, 2, 2, truncate_newest)
    said = [line.strip() for line in output.splitlines() if "skipped" in line]
    ok = max(*same.values(), cut) <= 1e-12 and max(other.values()) <= 1e-6 and bool(said)
    text = ", ".join(f"{ranks} ranks {move:.0e} m" for ranks, move in same.items())
    text += "".join(f", {written} -> {read} ranks {move:.0e} d" for (written, read), move in other.items())
    return Figure(f"{text}; newest truncated: {cut:.0e} m, {said[0] if said else 'no message'}", ok)


@TABLE.row("lost particles", claim="no particle is lost; lost ones are counted by cause, too many end the run",
           asked="none in a dam break of 100k particles and 2 s; past the limit exit code 3 and a file of the culprits")
def lost_particles(context):
    with scratch(context, "lost") as folder:
        run = run_scene(context, scene(context, "dam_break"), folder / "run", timeout=4 * 3600, set={
            "domain.spacing": 0.0155 if context.quick else 0.0074, "time.end": 2, "max_lost_fraction": 1,
            "output.interval": 0, "output.checkpoint_interval": 0})
        steps = run.steps()
        causes = {cause: int(steps[cause].max()) for cause in ("lost by leak", "lost as non-finite", "flowed out")}
        first, last, end = int(steps["particles"][0]), int(steps["particles"][-1]), float(steps["time"][-1])
        # 1 km/s is metres a step: every particle is through the wall at once.
        failed = run_scene(context, scene(context, "dam_break"), folder / "failed", expect=None, set={
            "domain.spacing": 0.025, "liquids.water.velocity": "[1000, 0, 0]", "time.rule": "fixed",
            "time.step": "2 ms", "time.end": "20 ms", "max_lost_fraction": 0, "output.checkpoint_interval": 0})
        culprits = failed.folder / "lost_particles.csv"
        listed = len(Columns(culprits)) if culprits.exists() else 0
    ok = not any(causes.values()) and first == last and failed.finished.code == 3 and listed > 0
    text = ", ".join(f"{cause} {number}" for cause, number in causes.items())
    return Figure(f"{first} particles, {end:.2f} s, {len(steps)} steps: {text}; past the limit exit code "
                  f"{failed.finished.code}, {listed} culprits in lost_particles.csv", ok)


PARTICLES, QUICK_PARTICLES = 300_000, 60_000
SHARED = "the better of two runs"


def size(context):
    return QUICK_PARTICLES if context.quick else PARTICLES


@TABLE.row("outside the solve", claim="everything of a step outside the pressure solve, 300k particles, 2 ranks",
           asked="≤ 25 WU, aim 15; peak memory ≤ 2 kB per particle")
def outside_the_solve(context):
    runs = [bench(context, size(context), ranks=2) for _ in range(2)]
    work = better(runs, "WU", "outside the solve")
    memory = max(run["peak memory per particle [B]"] for run in runs)
    floor = runs[0]["least WU by bytes"]["outside the solve"]
    return Figure(f"{work:.1f} WU ({SHARED}; least by bytes {floor:.1f}), {memory:.0f} B per particle, "
                  f"{runs[0]['liquid particles']} particles", work <= 25 and memory <= 2000)


@TABLE.row("assembly", claim="assembly and hand-over of the pressure matrix",
           asked="≤ 6 WU; no second copy of the matrix")
def assembly(context):
    runs = [bench(context, size(context), ranks=2) for _ in range(2)]
    work = better(runs, "WU", "assemble")
    particles = runs[0]["liquid particles"]
    matrix = (12 * runs[0]["entries"]["max"] + 4 * runs[0]["rows"]["max"]) / particles
    # Besides PETSc's vectors, MPI and HDF5; a second copy would add as much as the matrix has.
    others = max(run["peak memory per particle [B]"] - run["own arrays per particle [B]"] for run in runs)
    borrowed = run_gtest(context, "solve_test", "Matrix.borrows_the_callers_values", ranks=2)
    return Figure(f"{work:.2f} WU ({SHARED}); changed values are seen without a hand-over: {borrowed.text()}; "
                  f"beyond the program's arrays {others:.0f} B per particle, the matrix has {matrix:.0f}",
                  work <= 6 and borrowed.ok)


SUMS = ("between phases", "step", "outside the solve", "solve")


@TABLE.row("2 ranks against 1", claim="300k particles on 2 ranks against 1",
           asked="≥ 1.7 times faster in every phase outside the solve; the solve within 15 % of what the bandwidth "
                 "of 1 and 2 processes allows")
def two_ranks_against_one(context):
    ones, twos = ([bench(context, size(context), ranks=ranks) for _ in range(3)] for ranks in (1, 2))
    faster = {name: better(ones, "seconds", name) / better(twos, "seconds", name)
              for name in ones[0]["seconds"] if name not in SUMS}
    solve = better(ones, "seconds", "solve") / better(twos, "seconds", "solve")
    allowed = max(run["triad of all ranks [B/s]"]["median"] / run["triad of one rank [B/s]"]["median"] for run in twos)
    imbalance = max(run["imbalance"]["median"] for run in twos)
    iterations = [runs[0]["iterations"]["median"] for runs in (ones, twos)]
    text = ", ".join(f"{name} {factor:.2f}" for name, factor in faster.items())
    return Figure(f"{ones[0]['liquid particles']} particles, the best of three runs: {text}; solve {solve:.2f} of {allowed:.2f} by "
                  f"the triad ({iterations[0]:.0f} and {iterations[1]:.0f} iterations); imbalance {imbalance:.3f}",
                  min(faster.values()) >= 1.7 and solve >= 0.85 * allowed)


@TABLE.row("frames", claim="frames open with Debian's python3-vtk9 and with h5py", asked="times, counts, units")
def frames(context):
    interval, number = 0.02, 4
    with scratch(context, "frames") as folder:
        run = run_scene(context, scene(context, "dam_break"), folder / "run", set={
            "domain.spacing": 0.025, "time.end": interval * number, "output.interval": interval,
            "output.fields": "[velocity, pressure, density, liquid, role]", "output.checkpoint_interval": 0})
        particles = int(run.steps()["particles"][0])
        expected = [interval * k for k in range(number + 1)]
        liquid = frame_readers.examine(run.frames(), expected, particles)
        solid = frame_readers.examine(run.frames(solids=True), None, None)
    return Figure(f"{liquid.text()}; solids: {solid.text()}", not liquid.faults and not solid.faults)
