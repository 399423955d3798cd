"""Row of `house` by clang-tidy. Most of its time goes to the headers of libraries, so that sources are looked at in batches, a translation
unit each; sources whose local names collide with those of others in their batch go into a later one."""

import concurrent.futures
import json
import os
import pathlib
import re
import shlex
import subprocess
import tempfile

from .house_sources import listing, some
from .house_tools import needed
from .table import Figure, Unmeasured

QUICK = 16  # files
BATCH = 16  # files of a translation unit
FINDING = re.compile(r"^(.*?):(\d+):\d+: (warning|error): .*\[([\w.,-]+)\]$")
ERROR = "clang-diagnostic-error"
WITH_VALUE = {"-isystem", "-include", "-I", "-D"}


def compile_flags(context):
    """Flags of all compilers' commands for sources that are no tests, each once, a tuple each."""
    path = context.build / "compile_commands.json"
    if not path.exists():
        raise Unmeasured(f"needs {path}: cmake --preset release")
    flags = {}
    for entry in json.loads(path.read_text()):
        if "tests" not in pathlib.Path(os.path.relpath(entry["file"], context.root)).parts:
            flags.update(dict.fromkeys(flags_of(shlex.split(entry["command"]), entry["file"])))
    return list(flags)


def flags_of(words, file):
    """Flags of a compiler's command without its source, its output and a launcher before it."""
    words = iter(words[next(i for i, word in enumerate(words) if word.startswith("-")):])
    flags = []
    for word in words:
        if word == "-o":
            next(words)
        elif word in WITH_VALUE:
            flags.append((word, next(words)))
        elif word not in ("-c", file):
            flags.append((word,))
    return flags


class Tidy:
    """clang-tidy over many sources with the flags of all of them."""

    def __init__(self, context, program):
        self.root, self.build, self.program = context.root, context.build, program
        self.flags = [word for flag in compile_flags(context) for word in flag]

    def found(self, files, checks=""):
        """Set of (file, line, check) in sources and in the headers that they include."""
        with tempfile.NamedTemporaryFile("w", suffix=".cpp") as unit:
            unit.write("".join(f'#include "{file}"\n' for file in files))
            unit.flush()
            command = [self.program, "--quiet", f"--config-file={self.root / '.clang-tidy'}", f"--checks={checks},-bugprone-suspicious-include",
                       unit.name, "--", *self.flags, "-Wno-everything", "-ferror-limit=0"]
            done = subprocess.run(command, capture_output=True, text=True, errors="replace", cwd=self.build)
        matches = (FINDING.match(line) for line in done.stdout.splitlines())
        return {(os.path.realpath(one[1]), int(one[2]), one[4]) for one in matches if one}

    def colliding(self, files):
        """Those of the files, never the first, that do not compile behind the others; half of them where a header does not."""
        errors = {file for file, _, check in self.found(files, "-*,readability-delete-null-pointer") if check == ERROR}
        return [file for file in files[1:] if os.path.realpath(file) in errors] or (files[len(files) // 2:] if errors else [])

    def batch(self, files):
        """(findings, files left out)"""
        left = []
        while len(files) > 1 and (out := self.colliding(files)):
            left += out
            files = [file for file in files if file not in out]
        return self.found(files), left

    def all(self, files):
        """Findings in all files, sorted."""
        found = set()
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            while files:
                batches = [files[i::-(-len(files) // BATCH)] for i in range(-(-len(files) // BATCH))]
                results = list(pool.map(self.batch, batches))
                found.update(*(findings for findings, _ in results))
                files = [file for _, left in results for file in left]
        return sorted(found)


def tidy(context):
    """With --quick a sample of the files."""
    program, version = needed(context, "clang-tidy")
    sources = [str(file) for folder in ("src", "kokkos", "mpi") for file in sorted((context.root / folder).rglob("*.cpp"))]
    files = context.sample(sources, QUICK)
    context.note([program, "--quiet", "--config-file=.clang-tidy", f"BATCH_OF_{BATCH}_FILES.cpp", "--", "FLAGS_OF_ALL"])
    found = [f"{os.path.relpath(file, context.root)}:{line}: {check}" for file, line, check in Tidy(context, program).all(files)]
    where = listing(context, "tidy", found)
    return Figure(f"clang-tidy {version}: {len(found)} findings in {len(files)} files{': ' + some(found) if found else ''} ({where})", not found)


def add_rows(table):
    table.row("tidy", claim="the checks of .clang-tidy", asked="no finding")(tidy)
