"""Runs of the program for the rows of a claim, and what they leave behind."""

import contextlib
import csv
import dataclasses
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

from .table import CommandFailed, TimedOut

# The same as tools/environment.sh: only what is unset gets a value.
ENVIRONMENT = {
    "OMPI_ALLOW_RUN_AS_ROOT": "1",
    "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1",
    "OMPI_MCA_rmaps_base_oversubscribe": "1",
    "OMPI_MCA_hwloc_base_binding_policy": "none",
    "OMPI_MCA_mpi_yield_when_idle": "1",
    "OMPI_MCA_btl_vader_single_copy_mechanism": "none",
    "OMP_NUM_THREADS": "1",
    "OMP_PROC_BIND": "false",
    "OPENBLAS_NUM_THREADS": "1",
}


def environment(extra=None):
    return {**ENVIRONMENT, **os.environ, **(extra or {})}


@dataclasses.dataclass(frozen=True)
class Finished:
    code: int
    output: str  # stdout and stderr together
    seconds: float


def execute(context, command, *, expect=0, timeout=3600, env=None, cwd=None):
    """Runs a command and notes it. expect: the required exit code, or None for any."""
    command = [str(word) for word in command]
    context.note(command)
    start = time.monotonic()
    try:
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              errors="replace", timeout=timeout, env=environment(env), cwd=cwd or context.root)
    except subprocess.TimeoutExpired:
        raise TimedOut(f"no end after {timeout} s") from None
    if expect is not None and done.returncode != expect:
        raise CommandFailed(f"exit code {done.returncode} instead of {expect}: {last_words(done.stdout)}")
    return Finished(done.returncode, done.stdout, time.monotonic() - start)


def last_words(output, lines=3):
    """The last lines that a program itself has written, without those of mpiexec behind them."""
    return " / ".join(output.split("-" * 40)[0].strip().splitlines()[-lines:])


def launched(ranks, command):
    """The command on a number of ranks; 0 means without MPI's launcher."""
    return [os.environ.get("MPIEXEC", "mpiexec"), "-n", ranks, *command] if ranks else list(command)


def built(context, name, under=""):
    """A program of the build folder by its name, wherever its target put it."""
    for path in sorted((context.build / under).rglob(name)):
        if path.is_file() and os.access(path, os.X_OK):
            return path
    raise CommandFailed(f"no program {name} in {context.build / under}: run tools/build first")


def treacle(context, *arguments, ranks=2, **options):
    """Runs the program treacle with any subcommand; see execute for the options."""
    return execute(context, launched(ranks, [built(context, "treacle"), *arguments]), **options)


class Columns:
    """A CSV file with units in its header: table["time"] is the column "time [s]", as an array of numbers."""

    def __init__(self, path):
        import numpy

        self.path = pathlib.Path(path)
        with open(self.path, newline="") as file:
            rows = [row for row in csv.reader(file) if row and not row[0].startswith("#")]
        if not rows:
            raise CommandFailed(f"{self.path} is empty")
        self.header, self._rows = rows[0], rows[1:]
        self._numpy = numpy

    def __len__(self):
        return len(self._rows)

    def names(self):
        return [title.split("[")[0].strip() for title in self.header]

    def __contains__(self, name):
        return name in self.names()

    def text(self, name):
        if name not in self:
            raise CommandFailed(f"{self.path} has no column {name!r}, but {', '.join(self.names())}")
        index = self.names().index(name)
        return [row[index] for row in self._rows]

    def __getitem__(self, name):
        return self._numpy.array([float(value) if value else self._numpy.nan for value in self.text(name)])

    def at(self, name, time, clock="time"):
        """Value at a time [s], linear between the rows."""
        return float(self._numpy.interp(time, self[clock], self[name]))


class RunFolder:
    """What a run leaves behind."""

    def __init__(self, folder, finished=None):
        self.folder = pathlib.Path(folder)
        self.finished = finished

    def steps(self):
        return Columns(self.folder / "steps.csv")

    def measurements(self):
        return Columns(self.folder / "measurements.csv")

    def bodies(self):
        return Columns(self.folder / "bodies.csv")

    def summary(self):
        return json.loads((self.folder / "summary.json").read_text())

    def manifest(self):
        return json.loads((self.folder / "manifest.json").read_text())

    def frames(self, solids=False):
        """Pairs (time [s], path) of the liquid's frames, or of the solids', in the order of their index."""
        series = [path for path in sorted(self.folder.rglob("*.hdf.series"))
                  if (path.name == "solid.hdf.series") == solids]
        if not series:
            raise CommandFailed(f"no index of frames under {self.folder}")
        index = json.loads(series[0].read_text())
        return [(entry["time"], series[0].parent / entry["name"]) for entry in index["files"]]

    def frame(self, number=-1, sorted_by="id"):
        """Arrays of a frame's particles by name, "position" among them; rows sorted by a field, or by None."""
        return read_frame(self.frames()[number][1], sorted_by)


def read_frame(path, sorted_by="id"):
    import h5py
    import numpy

    with h5py.File(path, "r") as file:
        root = file["VTKHDF"]
        arrays = {name: values[()] for name, values in root["PointData"].items()}
        arrays["position"] = root["Points"][()]
    if sorted_by:
        if sorted_by not in arrays:
            raise CommandFailed(f"{path} has no field {sorted_by!r}, but {', '.join(sorted(arrays))}")
        order = numpy.argsort(arrays[sorted_by], kind="stable")
        arrays = {name: values[order] for name, values in arrays.items()}
    return arrays


@contextlib.contextmanager
def scratch(context, name):
    """A folder that is new on entry and gone after; TREACLE_KEEP=1 keeps it."""
    context.scratch.mkdir(parents=True, exist_ok=True)
    folder = pathlib.Path(tempfile.mkdtemp(prefix=name.replace(" ", "_") + "-", dir=context.scratch))
    try:
        yield folder
    finally:
        if not os.environ.get("TREACLE_KEEP"):
            shutil.rmtree(folder, ignore_errors=True)


def stamped(context, folder, inputs=""):
    """The folder, made where it is missing, emptied where another build, a call of another size, or one of other inputs wrote it."""
    program = built(context, "treacle").stat()
    stamp = f"{program.st_size} {program.st_mtime_ns} {context.quick}" + (" smallest" if context.smallest else "") + inputs
    if (folder / "build").is_file() and (folder / "build").read_text() != stamp:
        shutil.rmtree(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "build").write_text(stamp)
    return folder


@contextlib.contextmanager
def kept(context, name):
    """A folder that stays when the row is stopped, so that its commands go on there; gone once it has its figure, or for another build."""
    folder = stamped(context, context.scratch / name.replace(" ", "_"))
    yield folder
    if not os.environ.get("TREACLE_KEEP"):
        shutil.rmtree(folder, ignore_errors=True)


def run_scene(context, scene, folder, *, ranks=2, set=None, arguments=(), **options):
    """treacle run SCENE --out FOLDER with overrides {key: value}; returns the RunFolder."""
    overrides = [word for key, value in (set or {}).items() for word in ("--set", f"{key}={value}")]
    finished = treacle(context, "run", scene, "--out", folder, *overrides, *arguments, ranks=ranks, **options)
    return RunFolder(folder, finished)


def resume(context, folder, *, ranks=2, arguments=(), **options):
    """treacle resume FOLDER; returns the RunFolder."""
    return RunFolder(folder, treacle(context, "resume", folder, *arguments, ranks=ranks, **options))
