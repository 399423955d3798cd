"""Rows of `repairs` on runs and their files: what is written when, by whom, and until when."""

import pathlib
import re
import tempfile

from .run import Columns, built, execute, launched, run_scene, scratch
from .table import Figure, Unmeasured

RUN_TESTS = "tests/run"
FLYING = """
schema_version: 1
title: A drop that flies out of the domain
domain:
  min: [0, 0, 0]
  max: [0.4, 0.4, 0.4]
  spacing: 2 cm
  gravity: [0, 0, 0]
  boundaries: {{x_max: {side}}}
liquids:
  - {{name: water, density: 1000, velocity: [4, 0, 0], shapes: [{{box: {{min: [0.1, 0.1, 0.1], max: [0.2, 0.2, 0.2]}}}}]}}
{outlets}method: {{kind: {kind}}}
time: {{end: 0.15}}
output: {{interval: 0}}
"""
OUTLET = "outlets:\n  - box: {min: [0.38, 0, 0], max: [0.4, 0.4, 0.4]}\n"


def driver(context, name, *arguments, env=None):
    """Runs a driver of tests/run; its output, and how many of its tests passed."""
    mpiexec = launched(1, [])[0]
    done = execute(context, ["/usr/bin/python3", "-B", context.root / RUN_TESTS / name, built(context, "treacle"), mpiexec, *arguments],
                   expect=None, env={"ASAN_OPTIONS": "detect_leaks=0", **(env or {})})
    ran = re.search(r"Ran (\d+) tests?", done.output)
    return done, f"{ran[1] if ran else 0} tests, " + ("all passed" if done.code == 0 else done.output.strip().splitlines()[-1])


def tested(*calls):
    """A row whose figure is that all tests of some drivers pass."""
    def measure(context):
        parts = [driver(context, *call) for call in calls]
        return Figure("; ".join(text for _, text in parts), all(done.code == 0 for done, _ in parts))

    return measure


def kills(context):
    done, text = driver(context, "kill_test.py", "Kill", env={"TREACLE_KILLS": "5" if context.quick else "30"})
    counted = re.search(r"\d+ kills, .*", done.output)
    return Figure(counted[0] if counted and done.code == 0 else text, done.code == 0 and counted is not None)


def lost_liquid(context):
    """Exit codes of a drop that leaves through an open side: lost, let go, taken by an outlet."""
    cases = {"open": ("open", "", 3), "outflow": ("{kind: open, outflow: true}", "", 0), "outlet": ("open", OUTLET, 0)}
    found, ok = [], True
    for kind in ("sph", "grid"):
        for name, (side, outlets, wanted) in cases.items():
            for ranks in (1, 2, 3):
                with scratch(context, "flying") as folder:
                    scene = folder / "scene.yaml"
                    scene.write_text(FLYING.format(kind=kind, side=side, outlets=outlets))
                    run = run_scene(context, scene, folder / "run", ranks=ranks, expect=None)
                    ok = ok and run.finished.code == wanted and (wanted == 0) == ("max_lost_fraction" not in run.finished.output)
                    found.append(f"{kind} {name} {run.finished.code}")
    return Figure("exit codes, on 1 to 3 ranks: " + ", ".join(dict.fromkeys(found)), ok)


def reproductions(context):
    """Each entry of tools/reproduce at its smallest size."""
    from reproduce_lib import entries

    failed, seconds = [], 0.0
    for name in sorted(entries.known()):
        with tempfile.TemporaryDirectory(prefix="treacle_reproduce_") as folder:
            done = execute(context, [context.root / "tools/reproduce", name, "--smallest", "--ranks", 1, "--build", context.build,
                                     "--out", folder], expect=None)
            tables = list(pathlib.Path(folder).glob("*.csv"))
            seconds += done.seconds
            if done.code != 0 or not any(len(Columns(path)) for path in tables):
                failed.append(name)
    total = len(entries.known())
    return Figure(f"{total - len(failed)} of {total} in {seconds:.0f} s" + "".join(f"; {name} fails" for name in failed), not failed)


def from_bare_clone(minutes, command):
    """A row whose figure is how long a command of tools/ takes in a clone of the last commit, without a compiler's cache."""
    def measure(context):
        if context.quick:
            raise Unmeasured("compiles the program, for minutes: without --quick")
        with tempfile.TemporaryDirectory(prefix="treacle_clone_") as folder:
            clone = pathlib.Path(folder) / "treacle"
            execute(context, ["git", "clone", "--quiet", "--depth", "1", f"file://{context.root}", clone])
            done = execute(context, [clone / command], expect=None, timeout=7200, env={"CCACHE_DISABLE": "1", "OMP_NUM_THREADS": "1"}, cwd=clone)
        said = re.search(r"\d+ passed, \d+ failed", done.output)
        text = f"{done.seconds / 60:.1f} min, exit code {done.code}" + (f", {said[0]}" if said else "")
        return Figure(text, done.code == 0 and done.seconds <= 60 * minutes)

    return measure


def add_rows(table):
    table.row("demo in time", claim="tools/demo in a bare clone, OMP_NUM_THREADS=1, no cache, packages there", asked="<= 12 min")(
        from_bare_clone(12, "tools/demo"))
    table.row("tests in time", claim="tools/test in a bare clone, OMP_NUM_THREADS=1, no cache, packages there", asked="<= 20 min")(
        from_bare_clone(20, "tools/test"))
    table.row("one run a folder", claim="run --overwrite and resume while another run writes, 1 and 2 ranks; after a kill",
              asked="exit code 2, the first run whole; a crash leaves no lock")(tested(("kill_test.py", "Folder")))
    table.row("kills", claim="30 SIGKILLs at random, resumed on 1 to 3 ranks",
              asked="every row of steps.csv, bodies.csv and measurements.csv once")(kills)
    table.row("lost connection", claim="SIGHUP, a closed pipe on standard output, 1 and 2 ranks",
              asked="a checkpoint and exit code 5; goes on to its end")(tested(("stop_test.py", "1"), ("stop_test.py", "2")))
    table.row("longer runs", claim="resume --until and --set; output.interval that does not divide time.end",
              asked="the straight run's end; a last frame; what the state follows from is refused")(tested(("continue_test.py",)))
    table.row("lost liquid", claim="a drop leaves through an open side, both methods",
              asked="exit code 3; 0 with outflow: true or an outlet")(lost_liquid)
    table.row("reproductions", claim="every entry of tools/reproduce at its smallest size", asked="exit code 0")(reproductions)
