"""Public declarations of headers, and which of them no comment explains.

A declaration is explained by a comment behind it, directly below it, or above it within its group: the lines about it without an empty one
between them. The comment of a type is one for the first group of its members, too, but for numbers, which need their unit.
"""

import dataclasses
import re

from . import functions, sources

# Functions and their declarations, data, types; not a type that is only named, nor an enum's values, which its comment covers.
KINDS = "fpmscgt"
LONE = re.compile(r"=\s*(default|delete)\s*;|\boverride\b|\boperator\s*=|^\s*~|^\s*(virtual\s+)?~")
OPENING = re.compile(r"^\s*(template\b.*>|public:|private:|protected:)\s*$")
TYPE = re.compile(r"^\s*(struct|class|union|enum)\b.*\{\s*$")
NUMBER = re.compile(r"^\s*(static |constexpr |const |inline )*"
                    r"(double|float|Vec3|Mat3|Array\w*<|Array[34]\b|std::(vector|array|optional|span)<(double|float|Vec3))")


@dataclasses.dataclass(frozen=True)
class Count:
    all: int
    bare: list     # "file:line: name" of those without a comment
    numbers: list  # those of them that hold numbers, whose unit is not there

    @property
    def share(self):
        return len(self.bare) / max(1, self.all)


def hidden(found):
    """Qualified names of types that are not public, whose members are not either."""
    return {f"{one.scope}::{one.name}" for one in found if one.access in ("private", "protected")}


def public(found):
    private = hidden(found)
    for one in found:
        within = any(one.scope == name or one.scope.startswith(name + "::") for name in private)
        if one.access not in ("private", "protected") and not within and "__anon" not in one.name:
            yield one


def has_comment(line):
    return any(found[0].startswith("//") for found in sources.HIDING.finditer(line))


def last_line(lines, one):
    """Number of the line on which the declaration itself ends: at its semicolon or brace."""
    for number in range(one.line, min(one.line + 12, len(lines)) + 1):
        if re.search(r"[;{]", sources.code(lines[number - 1], strings=False)):
            return number
    return one.line


def above(lines, number):
    """Numbers of the lines above this one in its group, upwards; the first that opens the scope is the last of them."""
    own = indent(lines[number - 1])
    for other in range(number - 1, 0, -1):
        line = lines[other - 1]
        if not line.strip():
            return
        yield other
        if indent(line) < own and not OPENING.match(line):
            return


def has_comment_above(lines, number, types):
    for other in above(lines, number):
        line = lines[other - 1]
        if sources.COMMENT.match(line):
            return indent(line) == indent(lines[number - 1])
        if types and TYPE.match(line):
            return has_comment_above(lines, other, types=False)
    return False


def explained(lines, one):
    last = last_line(lines, one)
    if any(has_comment(line) for line in lines[one.line - 1:last]):
        return True
    if last < len(lines) and sources.COMMENT.match(lines[last]) and indent(lines[last]) > indent(lines[one.line - 1]):
        return True
    return has_comment_above(lines, one.line, types=not is_number(lines, one))


def is_number(lines, one):
    return one.kind == "member" and bool(NUMBER.match(lines[one.line - 1]))


def indent(line):
    return len(line) - len(line.lstrip())


def names_parameters(one, line):
    """A constructor from nothing, and what the compiler makes, have nothing to explain."""
    return not (LONE.search(line) or one.name.startswith(("operator", "~")))


def count(root):
    headers = [path for path in sources.sources(root) if path.suffix == ".hpp"]
    found = functions.symbols(root, headers, KINDS)
    lines = {str(path.relative_to(root)): path.read_text().splitlines() for path in headers}
    total, bare, numbers = 0, [], []
    for one in public(found):
        own = lines[one.path]
        if "(" in one.signature and not names_parameters(one, own[one.line - 1]):
            continue
        total += 1
        if not explained(own, one):
            bare.append(f"{one.path}:{one.line}: {one.name}")
            if is_number(own, one):
                numbers.append(bare[-1])
    return Count(total, sorted(bare), sorted(numbers))
