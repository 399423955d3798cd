"""Pictures of the frames of runs, for figures that put them side by side."""

from claims_lib.run import treacle


def drawn(context, results, run, field, span, frame):
    """The PNG of one frame of a run, coloured by a field from the low to the high end of a range "LOW:HIGH"."""
    into = run.folder / f"picture_{field}_{frame}"
    treacle(context, "render", run.folder, "--field", field, "--frames", frame, "--range", span, "--no-movie",
            "--size", "960x600", "--out", into, ranks=results.ranks)
    return next(into.glob("*.png"))
