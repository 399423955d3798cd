"""Rows of `house` by the tools that many projects share: clang-format, clang-tidy, codespell."""

import concurrent.futures
import json
import os
import re
import shutil
import subprocess

from .house_sources import listing, some
from .table import Figure, Unmeasured

TIDY_QUICK = 8  # files
FINDING = re.compile(r"^(.*?):(\d+):\d+: (?:warning|error): .*\[([\w.,-]+)\]$")


def needed(context, name):
    """Path of a program, noted with its version."""
    path = shutil.which(name)
    if not path:
        raise Unmeasured(f"needs {name}; Debian has a package of that name")
    version = subprocess.run([path, "--version"], capture_output=True, text=True).stdout
    return path, re.search(r"\d+\.\d+\.\d+", version)[0]


def layout(context):
    _, version = needed(context, "clang-format")
    command = [context.root / "tools/format", "--check"]
    context.note(command)
    done = subprocess.run(command, capture_output=True, text=True)
    files = done.stdout.splitlines()
    where = listing(context, "format", files)
    return Figure(f"clang-format {version}: {len(files)} files differ ({where})", done.returncode == 0)


def compiled_files(context):
    """Sources of the build folder's compile_commands.json that are not tests."""
    path = context.build / "compile_commands.json"
    if not path.exists():
        raise Unmeasured(f"needs {path}: cmake --preset release")
    files = sorted({entry["file"] for entry in json.loads(path.read_text())})
    inside = [file for file in files if re.match(r"(src|kokkos|mpi)/", os.path.relpath(file, context.root))]
    return [file for file in inside if os.path.exists(file)]


def tidy_findings(context, program, file):
    """Set of "file:line: check" of a source and of the headers that it includes."""
    command = [program, "--quiet", "-p", str(context.build), file]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    found = (FINDING.match(line) for line in done.stdout.splitlines())
    return {f"{os.path.relpath(os.path.realpath(one[1]), context.root)}:{one[2]}: {one[3]}" for one in found if one}


def tidy(context):
    """With --quick a sample of the files."""
    program, version = needed(context, "clang-tidy")
    files = context.sample(compiled_files(context), TIDY_QUICK)
    context.note([program, "--quiet", "-p", context.build, "FILE"])
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        found = sorted(set().union(*pool.map(lambda file: tidy_findings(context, program, file), files)))
    where = listing(context, "tidy", found)
    return Figure(f"clang-tidy {version}: {len(found)} findings in {len(files)} files{': ' + some(found) if found else ''} ({where})", not found)


def spelling(context):
    """Right words that are not in its dictionary stand in .codespellrc, with a reason."""
    program, version = needed(context, "codespell")
    tracked = subprocess.run(["git", "ls-files"], capture_output=True, text=True, cwd=context.root, check=True).stdout.splitlines()
    context.note([program, "$(git ls-files)"])
    done = subprocess.run([program, *tracked], capture_output=True, text=True, errors="replace", cwd=context.root)
    found = [line for line in done.stdout.splitlines() if "==>" in line]
    where = listing(context, "spelling", found)
    return Figure(f"codespell {version}: {len(found)} findings in {len(tracked)} files{': ' + some(found, '; ') if found else ''} ({where})",
                  not found)


def add_rows(table):
    table.row("format", claim="the layout of .clang-format", asked="no file differs")(layout)
    table.row("tidy", claim="the checks of .clang-tidy", asked="no finding")(tidy)
    table.row("spelling", claim="spelling of sources and documents", asked="no finding")(spelling)
