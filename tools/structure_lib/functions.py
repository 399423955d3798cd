"""Sizes of functions and files, as Universal Ctags finds them."""

import dataclasses
import json
import shutil
import subprocess

from . import sources

# Words before a function that are macros, not types.
MACROS = ("KOKKOS_INLINE_FUNCTION", "KOKKOS_FUNCTION", "KOKKOS_FORCEINLINE_FUNCTION", "TREACLE_AVX", "TREACLE_DATA")


class Missing(Exception):
    """A tool that is not on this machine."""


@dataclasses.dataclass(frozen=True)
class Symbol:
    """A function, type or member that a file declares or defines."""

    path: str
    line: int
    end: int
    name: str
    kind: str
    scope: str
    access: str
    signature: str

    @property
    def lines(self):
        return self.end - self.line + 1

    @property
    def parameters(self):
        return count_parameters(self.signature)


def count_parameters(signature):
    """Number of parameters of "(int a, std::pair<int, int> b = {1, 2}) const"."""
    depth, count, seen = 0, 0, False
    for letter in signature.replace("->", "").replace("<<", ""):
        depth += letter in "([{<"
        depth -= letter in ")]}>"
        if depth == 0:
            break
        count += letter == "," and depth == 1
        seen = seen or letter not in "( "
    inside = signature.strip("() ")
    return count + 1 if seen and inside != "void" else 0


def symbols(root, paths, kinds="f"):
    """Symbols of these kinds of ctags (f function, p prototype, m member, c class, s struct, g enum, t type)."""
    if not shutil.which("ctags"):
        raise Missing("needs universal-ctags")
    command = ["ctags", "--language-force=C++", f"--kinds-C++={kinds}", "--fields=+neSaZ", "--output-format=json", "-f", "-", "-L", "-"]
    command += [word for macro in MACROS for word in ("-I", macro)]
    done = subprocess.run(command, input="\n".join(str(path) for path in paths), capture_output=True, text=True, check=True)
    found = [json.loads(line) for line in done.stdout.splitlines()]
    return [Symbol(path=one["path"].removeprefix(f"{root}/"), line=one["line"], end=one.get("end", one["line"]), name=one["name"],
                   kind=one["kind"], scope=one.get("scope", ""), access=one.get("access", ""), signature=one.get("signature", ""))
            for one in found if one["_type"] == "tag"]


@dataclasses.dataclass(frozen=True)
class Sizes:
    functions: list  # by their lines, longest first
    files: list      # pairs (lines, path), longest first

    def quantile(self, share):
        ordered = sorted(one.lines for one in self.functions)
        return ordered[int(share * (len(ordered) - 1))]

    def longer(self, lines):
        return [one for one in self.functions if one.lines > lines]

    def with_more_parameters(self, count):
        return [one for one in self.functions if one.parameters > count]

    def longer_files(self, lines):
        return [one for one in self.files if one[0] > lines]


def sizes(root):
    paths = sources.sources(root)
    files = sorted(((len(path.read_text().splitlines()), str(path.relative_to(root))) for path in paths), reverse=True)
    found = [one for one in symbols(root, paths) if one.kind == "function"]
    return Sizes(sorted(found, key=lambda one: (-one.lines, one.path, one.line)), files)
