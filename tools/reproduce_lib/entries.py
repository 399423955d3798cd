"""What can be reproduced, and what a reproduction writes.

A module of this folder declares one with

    @entry("figure-3.9", "what it shows", quick=240)
    def figure(context, results): ...

context is that of the claims, for run_scene and its like; with context.quick it ends within ten minutes on two cores, with
context.smallest within seconds (context.pick chooses).
"""

import contextlib
import csv
import dataclasses
import importlib
import json
import pathlib
import sys
import time


@dataclasses.dataclass(frozen=True)
class Entry:
    name: str
    title: str
    run: object  # function of a Context and Results
    quick: int   # what it takes with --quick on two cores [s]
    shares: str = ""  # name of the studies that it shares with others: the second of them takes seconds


_entries = {}


def entry(name, title, quick, shares=""):
    if name in _entries:
        raise ValueError(f"two entries named {name!r}")

    def declare(run):
        _entries[name] = Entry(name, title, run, quick, shares)
        return run

    return declare


def known():
    """All entries by name: those of every module in this folder."""
    for path in sorted(pathlib.Path(__file__).parent.glob("*.py")):
        if path.stem not in ("__init__", "entries"):
            importlib.import_module(f"{__package__}.{path.stem}")
    return dict(_entries)


def text_of(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


class Results:
    """The files of one entry, under its folder."""

    def __init__(self, folder, ranks, out=sys.stdout, studies=None):
        self.folder = pathlib.Path(folder)
        self.studies = studies or self.folder / "studies"  # shared by several entries
        self.ranks = ranks
        self.files = []
        self._out = out

    def say(self, text):
        print(text, file=self._out, flush=True)

    def table(self, name, header, rows):
        """Writes NAME.csv, and prints it. header: titles with units, "time [s]"; rows: of texts, numbers or None."""
        path = self.new(f"{name}.csv")
        rows = [["" if value is None else value for value in row] for row in rows]
        with open(path, "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *rows])
        lines = [header, *([text_of(value) for value in row] for row in rows)]
        widths = [max(len(line[k]) for line in lines) for k in range(len(header))]
        for line in lines:
            self.say("  ".join(word.rjust(width) for word, width in zip(line, widths)))

    def curves(self, name, header, rows):
        """Writes NAME.csv without printing it: the points of a figure."""
        with open(self.new(f"{name}.csv"), "w", newline="") as file:
            csv.writer(file, lineterminator="\n").writerows([header, *rows])

    @contextlib.contextmanager
    def figure(self, name, columns=1, rows=1, size=(5.5, 4)):
        """Pyplot's axes of NAME.png, one, a row or rows of them, each of a size [inches]; written on leaving."""
        import matplotlib

        matplotlib.use("Agg")
        from matplotlib import pyplot

        figure, axes = pyplot.subplots(rows, columns, figsize=(size[0] * columns, size[1] * rows))
        try:
            yield axes
            figure.tight_layout()
            figure.savefig(self.new(f"{name}.png"), dpi=120)
        finally:
            pyplot.close(figure)

    def pictures(self, name, rows, size=(4.8, 3)):
        """NAME.png of pictures side by side. rows: lists of equal length of (title, path of a PNG or its pixels)."""
        import numpy
        from matplotlib import image

        cells = [cell for row in rows for cell in row]
        with self.figure(name, columns=len(rows[0]), rows=len(rows), size=size) as axes:
            for one, (title, picture) in zip(numpy.ravel(axes), cells):
                one.set_axis_off()
                one.set_title(title, fontsize=8)
                one.imshow(picture if isinstance(picture, numpy.ndarray) else image.imread(picture))

    def new(self, name):
        """Path of a file of the entry, to be written by the caller."""
        self.folder.mkdir(parents=True, exist_ok=True)
        path = self.folder / name
        self.files.append(path)
        return path


def reproduce(one, context, folder, ranks, out=sys.stdout, studies=None):
    """Runs an entry; its folder gets its files and commands.json, which has the commands."""
    results = Results(folder, ranks, out, studies)
    start = time.monotonic()
    results.say(f"{one.name}: {one.title}")
    one.run(context, results)
    record = {"name": one.name, "quick": context.quick, "smallest": context.smallest, "ranks": ranks, "commands": context.commands,
              "seconds": round(time.monotonic() - start, 1)}
    (results.new("commands.json")).write_text(json.dumps(record, indent=2) + "\n")
    for path in results.files:
        results.say(f"written to {path}")
    return results
