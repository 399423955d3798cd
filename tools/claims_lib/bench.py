"""`treacle bench` and its figures."""

import json

from .run import scratch, treacle


def bench(context, particles, *, ranks):
    """What the program writes with --json."""
    with scratch(context, "bench") as folder:
        path = folder / "bench.json"
        treacle(context, "bench", "kernels", "--particles", particles, "--json", path, ranks=ranks)
        return json.loads(path.read_text())


def pressure_bench(context, particles, preconditioners, residuals, *, ranks, overrides=None, sweeps=0):
    """What `treacle bench pressure` writes with --json. overrides: {key: value}."""
    words = [word for name in preconditioners for word in ("--preconditioner", name)]
    words += [word for residual in residuals for word in ("--residual", f"{residual:g}")]
    words += [word for key, value in (overrides or {}).items() for word in ("--set", f"{key}={value}")]
    words += ["--sweeps", sweeps] if sweeps else []
    with scratch(context, "bench") as folder:
        path = folder / "bench.json"
        treacle(context, "bench", "pressure", "--particles", particles, *words, "--json", path, ranks=ranks)
        return json.loads(path.read_text())


def better(runs, kind, name):
    """The smaller of the medians: other programs on the machine make a run slower, never faster."""
    return min(run[kind][name]["median"] for run in runs)
