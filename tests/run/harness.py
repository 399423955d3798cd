"""What the drivers of this folder share: launching the program, and reading the files of a run."""
import json
import os
import shutil
import signal
import subprocess
import tempfile
import time
import unittest

import h5py
import numpy

HERE = os.path.dirname(os.path.abspath(__file__))
SCENES = os.path.join(HERE, "scenes")
INPUTS = os.path.join(os.path.dirname(os.path.dirname(HERE)), "inputs")

# Small enough a residual that the answer does not show how the ranks share the work.
TIGHT = {"method.pressure.stop": "residual", "method.pressure.residual": "1e-10", "output.double_precision": "true"}
TIGHT_ON_GRID = {"method.grid.pressure.residual": "1e-12", "method.grid.viscosity.residual": "1e-12",
                 "method.grid.stokes.residual": "1e-12", "method.grid.stokes.max_iterations": "2000",
                 "output.double_precision": "true"}


class Program:
    """Set by the driver's main before the tests run."""
    path = ""
    launcher = ""


def command_line(arguments, ranks):
    command = [Program.path, *map(str, arguments)]
    return [Program.launcher, "-n", str(ranks), *command] if ranks > 1 else command


def overrides(values):
    return [word for key, value in values.items() for word in ("--set", f"{key}={value}")]


def stat_of(pid):
    """Name, state and parent of a process, None when it is gone."""
    try:
        with open(f"/proc/{pid}/stat") as file:
            text = file.read()
    except OSError:
        return None
    name = text[text.index("(") + 1:text.rindex(")")]
    state, parent = text[text.rindex(")") + 2:].split()[:2]
    return name, state, int(parent)


def processes_of(pid):
    """A process and all that it has started, children last."""
    parents = {}
    for entry in filter(str.isdigit, os.listdir("/proc")):
        found = stat_of(entry)
        if found:
            parents.setdefault(found[2], []).append(int(entry))
    found = [pid]
    for one in found:
        found += parents.get(one, [])
    return found


def ranks_of(process):
    """Processes of the program that a launcher, or nothing, has started."""
    name = os.path.basename(Program.path)
    return [pid for pid in processes_of(process.pid) if (stat_of(pid) or ("",))[0] == name]


def kill_all(process):
    """SIGKILL for the launcher and all ranks; returns when none of them runs any more."""
    pids = processes_of(process.pid)
    for pid in pids:
        try:
            os.kill(pid, signal.SIGKILL)
        except ProcessLookupError:
            pass
    process.communicate()
    end = time.monotonic() + 60
    while any((stat_of(pid) or ("", "Z"))[1] not in "ZX" for pid in pids):
        if time.monotonic() > end:
            raise TimeoutError(f"{pids} are still there")
        time.sleep(0.01)


def environment_for(code):
    """The environment of a command that is to end with an exit code. Open MPI's launcher waits a second for the ranks that it ends: a
    command that is refused has nothing to save."""
    return {**os.environ, "OMPI_MCA_odls_base_sigkill_timeout": "0"} if code == 2 else None


class Workplace(unittest.TestCase):
    """A folder of its own for each test; commands run in it."""

    def setUp(self):
        self.folder = tempfile.mkdtemp(prefix="treacle_run_")
        self.addCleanup(shutil.rmtree, self.folder, ignore_errors=True)

    def path(self, *parts):
        return os.path.join(self.folder, *parts)

    def treacle(self, *arguments, ranks=1, code=0):
        done = subprocess.run(command_line(arguments, ranks), capture_output=True, text=True, timeout=240,
                              cwd=self.folder, env=environment_for(code))
        self.assertEqual(done.returncode, code, f"{arguments} on {ranks} ranks: {done.stdout}\n{done.stderr}")
        return done

    def start(self, *arguments, ranks=1, **options):
        """The process of a command, its output in one pipe."""
        return subprocess.Popen(command_line(arguments, ranks), cwd=self.folder, stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, text=True, **options)

    def wait_for_frames(self, process, run, count=3):
        end = time.monotonic() + 200
        while time.monotonic() < end and process.poll() is None:
            folder = self.path(run, "frames")
            if os.path.isdir(folder) and len([n for n in os.listdir(folder) if n.startswith("frame_0")]) >= count:
                return
            time.sleep(0.02)
        self.fail("the run did not get under way: " + process.communicate(timeout=60)[0])

    def run_scene(self, scene, out, ranks, values, code=0, extra=()):
        return self.treacle("run", scene, "--out", out, *overrides(values), *extra, ranks=ranks, code=code)

    def frame(self, run, number=-1):
        """Arrays of a frame by name, sorted by id."""
        with open(self.path(run, "frames", "frame.hdf.series")) as file:
            entry = json.load(file)["files"][number]
        with h5py.File(self.path(run, "frames", entry["name"]), "r") as file:
            root = file["VTKHDF"]
            arrays = {name: values[()] for name, values in root["PointData"].items()}
            arrays["position"] = root["Points"][()]
        order = numpy.argsort(arrays["id"], kind="stable")
        arrays = {name: values[order] for name, values in arrays.items()}
        arrays["time"] = entry["time"]
        return arrays

    def largest_move(self, one, other):
        """Largest distance of a particle between two frames [m]; both must hold the same particles."""
        numpy.testing.assert_array_equal(one["id"], other["id"])
        return float(numpy.abs(one["position"] - other["position"]).max(initial=0))

    def steps(self, run):
        return self.columns(run, "steps.csv")

    def columns(self, run, table):
        """Columns of a CSV file by their titles."""
        table = numpy.genfromtxt(self.path(run, table), delimiter=",", names=True, deletechars="", replace_space=" ")
        return numpy.atleast_1d(table)

    def checkpoints(self, run):
        folder = self.path(run, "checkpoints")
        return sorted(os.path.join(folder, name) for name in os.listdir(folder))


def main(module_argv, usage):
    """PROGRAM MPIEXEC are taken off the command line; the rest names tests."""
    Program.path, Program.launcher = module_argv[1], module_argv[2]
    unittest.main(argv=[module_argv[0], *module_argv[3:]])
