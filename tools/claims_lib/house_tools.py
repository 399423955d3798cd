"""Rows of `house` by the tools that many projects share: clang-format and codespell."""

import re
import shutil
import subprocess

from .house_sources import listing, some
from .table import Figure, Unmeasured


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
    table.row("spelling", claim="spelling of sources and documents", asked="no finding")(spelling)
