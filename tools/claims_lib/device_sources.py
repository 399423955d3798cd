"""Rows of `device` about the sources and what they are built with: loops of the host, lines, simulated devices, nvcc."""

import collections
import dataclasses
import pathlib
import re
import shutil
import subprocess

from structure_lib import functions, loops, sources

from .house_sources import listing, some
from .table import Figure, Unmeasured

ALLOWED = pathlib.Path(__file__).with_name("device_host_loops.txt")
BEFORE = "b0d29e87"  # the last commit in which all vectors and products of the solve layer are loops of the host
SOLVERS_OF_SPH = ("src/sph/iisph/bounded_solve.", "src/sph/iisph/orthomin_correction.", "src/sph/pressure/complementarity.",
                  "src/sph/pressure/pressure_hierarchy.", "src/sph/viscosity/implicit_viscosity.", "src/sph/viscosity/multigrid/",
                  "src/sph/viscosity/operator/viscous_vectors.")
SOLVES = ("src/solve/", *SOLVERS_OF_SPH)
# Directions of conjugate gradients are renewed by the quotient of two r.z; a scalar product of two arrays stands for the vector operations.
CONJUGATE_GRADIENTS = re.compile(r"\bturn\([^;]*/ ?\w*rz\b")
SCALAR_PRODUCT = re.compile(r"\bdouble dot\([^)]*(?:span|Array|vector)[^)]*\)\s*\{")
PLANTED = "void planted(const double* x, int particles) {\n    for (int i = 0; i < particles; ++i) use(x[i]);\n}\n"


@dataclasses.dataclass(frozen=True)
class Allowed:
    path: str
    function: str
    loops: int
    why: str


def allowed(text):
    """Entries of the list of loops that may stay: PATH | FUNCTION, FUNCTION 2 | why."""
    found = []
    for line in text.splitlines():
        if line.strip() and not line.startswith("#"):
            path, names, why = (part.strip() for part in line.split("|"))
            for name, _, count in (entry.strip().partition(" ") for entry in names.split(",")):
                found.append(Allowed(path, name, int(count or 1), why))
    return found


def judged(found, entries):
    """Loops of functions that have more of them than the list lets pass, and its entries that let more pass than there are."""
    known = {(one.path, one.function): one.loops for one in entries}
    there = collections.Counter((one.path, one.function) for one in found)
    left = [one for one in found if there[one.path, one.function] > known.get((one.path, one.function), 0)]
    return left, [one for one in entries if there[one.path, one.function] < one.loops]


def host_loops(context):
    """A loop planted in a source must be found, or the check is worth nothing."""
    try:
        found = loops.find(context.root)
    except functions.Missing as missing:
        raise Unmeasured(str(missing)) from None
    left, stale = judged(found, allowed(ALLOWED.read_text()))
    where = listing(context, "host_loops", [f"{one.path}:{one.line}: {one.function}: for ({one.head})" for one in left])
    folders = collections.Counter("/".join(one.path.split("/")[:2]) for one in left)
    blind = len(loops.host_loops(PLANTED)) != 1
    text = f"{len(left)} loops over particles, cells, rows or faces on the host, in {len({one.path for one in left})} files (" + ", ".join(
        f"{folder} {count}" for folder, count in folders.most_common()) + f"), {len(found) - len(left)} that may stay ({where})"
    text += f"; more on the list than there are: {some(f'{one.path} {one.function}' for one in stale)}" if stale else ""
    return Figure(text + ("; THE CHECK IS BLIND to a planted loop" if blind else ""), not left and not stale and not blind)


def simulated_device(context):
    """No memory space of the tree, its presets or its witness has pages that are protected outside of kernels."""
    protecting = [path for path in sources.sources(context.root) if "mprotect" in path.read_text()]
    if not protecting:
        return Figure("not built: no memory space of the tree protects its pages outside of kernels; copies of a step are not counted", False)
    raise Unmeasured(f"{protecting[0].relative_to(context.root)} protects pages; no run with it is known to this row yet")


def count_lines(text):
    """Lines of code: neither empty nor comments."""
    return sum(bool(line.strip()) for line in sources.code(text).splitlines())


def git(context, *words):
    command = ["git", *words]
    done = subprocess.run(command, capture_output=True, text=True, cwd=context.root)
    if done.returncode:
        raise Unmeasured(f"needs the history of the sources: {' '.join(command)}: {done.stderr.strip().splitlines()[-1]}")
    return done.stdout


def lines_before(context):
    """Of the solve layer and of the solvers in src/sph at the commit before; {path: lines}."""
    names = git(context, "ls-tree", "-r", "--name-only", BEFORE, "src/solve", "src/sph").splitlines()
    chosen = [name for name in names if name.startswith(SOLVES) and name.endswith(sources.SUFFIXES)]
    context.note(["git", "show", f"{BEFORE}:src/solve"])
    return {name: count_lines(git(context, "show", f"{BEFORE}:{name}")) for name in chosen}


def lines_now(context):
    paths = {path.relative_to(context.root).as_posix(): path for path in sources.sources(context.root, ("src/solve", "src/sph"))}
    return {name: count_lines(path.read_text()) for name, path in paths.items() if name.startswith(SOLVES)}


def holding(context, pattern):
    """Files of the three solving modules whose code holds a pattern."""
    found = sources.sources(context.root, ("kokkos", *loops.FOLDERS))
    return [path.relative_to(context.root).as_posix() for path in found if pattern.search(sources.code(path.read_text()))]


def lines(context):
    before, now = lines_before(context), lines_now(context)
    layer = [sum(count for name, count in side.items() if name.startswith("src/solve/")) for side in (before, now)]
    total = [sum(side.values()) for side in (before, now)]
    methods, products = holding(context, CONJUGATE_GRADIENTS), holding(context, SCALAR_PRODUCT)
    text = (f"{total[0]} lines of code at {BEFORE}, now {total[1]} (src/solve {layer[0]}, now {layer[1]}); conjugate gradients in "
            f"{len(methods)} files ({', '.join(methods)}), vector operations in {len(products)} ({', '.join(products)})")
    return Figure(text, total[1] < total[0] and len(methods) == 1 and len(products) == 1)


def cuda(context):
    """nvcc compiles nothing of the tree without a Kokkos that has CUDA: KOKKOS_SOURCE or Kokkos_ROOT of one."""
    program = shutil.which("nvcc") or (shutil.which("nvcc", path="/usr/local/cuda/bin"))
    if not program:
        raise Unmeasured("not measurable here: no nvcc")
    version = re.search(r"release ([\d.]+)", subprocess.run([program, "--version"], capture_output=True, text=True).stdout)
    card = shutil.which("nvidia-smi")
    if not (context.root / "build/cuda/CMakeCache.txt").exists():
        raise Unmeasured(f"nvcc {version[1] if version else 'of an unknown version'} is there{'' if card else ', no GPU is'}; not measurable "
                         "without build/cuda: Kokkos_ROOT=DIR tools/build cuda")
    raise Unmeasured(f"build/cuda is there, {'its tests on a GPU are not run by this row yet' if card else 'no GPU is'}")


def add_rows(table):
    table.row("host loops", claim="loops written with for, outside of kernels, in src/solve, src/sph and src/grid",
              asked="none over particles, cells, rows or faces but for output, checkpoints, re-cutting, contacts, the coarsest level; a wrong one "
                    "is found")(host_loops)
    table.row("simulated device", claim="four scenes where memory of the device is protected outside of kernels",
              asked="no access of the host; copies of a step <= 1 kB a rank outside of output")(simulated_device)
    table.row("lines", claim=f"src/solve and the solvers of src/sph, beside those at {BEFORE}",
              asked="fewer; conjugate gradients once, vector operations once")(lines)
    table.row("CUDA", claim="compiles and links whole; tests and a step of 1M particles on a GPU",
              asked="no function of the host called from a kernel; tests pass; host's share <= 5 %")(cuda)
