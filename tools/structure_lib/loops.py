"""Loops that run on the host: those outside of kernels and of functions that kernels call."""

import collections
import dataclasses
import re

from . import functions, sources

FOLDERS = ("src/solve", "src/sph", "src/grid")
KERNEL = re.compile(r"\bKOKKOS_(?:CLASS_)?LAMBDA\b|\bKOKKOS_(?:FORCEINLINE_|INLINE_)?FUNCTION\b")
LOOP = re.compile(r"\bfor\s*\(")
UNNAMED = "__anon"  # what ctags calls namespaces and functions without a name
NAMESPACES = ("treacle", "solve", "sph", "grid")
# Loops over a few things, whatever the number of particles: axes, corners, bodies, liquids, levels, arrays by name, entries of one row.
FEW_BOUNDS = re.compile(
    r"^$|^chang\w+$"
    r"|<=? ?(?:-?\d+(?:$| &&)|\d \* \w*dimensions|[MDs]\b|small\.s\b|[\w.>-]*(?:dimensions|corners|sides|levels|layers|sweeps|passes|lanes|width|depth|images|third|waves|"
    r"steps|iterations|liquids|parts|used|support_cells|sub_cells)_?(?:\(\)|\[\d\])?$)"
    r"|< ?[\w.()>-]*(?:bodies|rigid|loads|curves|inlets|groups|labels|slip|lengths|of_liquids|causes|modes|motion|shadows|rheology)_?(?:\.size\(\))?$"
    r"|\b\w*(?:offsets?|first|last)\w*[\[(](?!rows)[\w. +]+[\])]$|^\w+ < end$")
FEW_RANGES = re.compile(
    r": ?\{|^(?:const )?auto[&*]? (?:component|array|vector|vectors|part|field|message|face|stage|inlet)\b"
    r"|: ?[\w.>-]*(?:bodies|members|loads|inlets|lost|liquids|stages|sizes|row_|words)_?(?:\(\))?$")


@dataclasses.dataclass(frozen=True)
class Loop:
    """A loop of the host, the outermost of its nest that is not over a few things."""

    path: str
    line: int
    function: str  # with its type, as `Level::sweep`
    head: str      # between its parentheses


def closing(text, at):
    """Index behind the bracket that closes the one at an index."""
    pairs, depth = {"(": ")", "{": "}"}, 0
    opening = text[at]
    for index in range(at, len(text)):
        depth += (text[index] == opening) - (text[index] == pairs[opening])
        if depth == 0:
            return index + 1
    return len(text)


def body_end(text, at):
    """Index behind the body that follows, {...} or a statement up to its semicolon; brackets before it are passed over."""
    while at < len(text):
        if text[at] == "(":
            at = closing(text, at)
        elif text[at] == "{":
            return closing(text, at)
        elif text[at] == ";":
            return at + 1
        else:
            at += 1
    return at


def kernel_ranges(text):
    """Pairs of indices (begin, end) of kernels and of functions for them."""
    return [(match.start(), body_end(text, match.end())) for match in KERNEL.finditer(text)]


def host_loops(text):
    """Pairs (index, head) of the loops of a source without comments."""
    kernels, found, inside = kernel_ranges(text), [], 0
    for match in LOOP.finditer(text):
        if match.start() < inside or any(begin <= match.start() < end for begin, end in kernels):
            continue
        end = closing(text, match.end() - 1)
        head = " ".join(text[match.end():end - 1].split())
        if not over_few(head):
            found.append((match.start(), head))
            inside = body_end(text, end)
    return found


def over_few(head):
    """Whether the number of passes does not grow with the liquid, by the condition or the range in a loop's head."""
    parts = [part.strip() for part in head.split(";")]
    return bool(FEW_BOUNDS.search(parts[1]) if len(parts) == 3 else FEW_RANGES.search(head))


def named(root, found):
    """Loops [(path, line, head)] with the functions that hold them."""
    spans = collections.defaultdict(list)
    for one in functions.symbols(root, sorted({root / path for path, _, _ in found})):
        spans[one.path].append(one)
    return [Loop(path, line, function_around(spans[path], line), head) for path, line, head in found]


def function_around(symbols, line):
    """Name, with its type, of the innermost function that holds a line; lambdas belong to the function around them."""
    around = [one for one in symbols if one.line <= line <= one.end and not one.name.startswith(UNNAMED)]
    if not around:
        return ""
    inner = max(around, key=lambda one: one.line)
    scope = inner.scope.split("::")[-1]
    return inner.name if scope.startswith(UNNAMED) or scope in NAMESPACES or not scope else f"{scope}::{inner.name}"


def find(root, folders=FOLDERS):
    """The host's loops of the sources, in the order of files and lines."""
    found = []
    for path in sources.sources(root, folders):
        text = sources.code(path.read_text(), strings=False)
        found += [(path.relative_to(root).as_posix(), text.count("\n", 0, at) + 1, head) for at, head in host_loops(text)]
    return named(root, found)
