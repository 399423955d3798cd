"""The C++ sources of the tree, their comments and their code."""

import dataclasses
import re

FOLDERS = ("src", "kokkos", "mpi")
SUFFIXES = (".cpp", ".hpp")

COMMENT = re.compile(r"^\s*//")
# Comments, strings (raw ones first) and characters, in the order of their precedence; digits' separators are none.
HIDING = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:\\.|[^"\\\n])*"|(?<![0-9a-fA-F])\'(?:\\.|[^\'\\\n])+\'', re.DOTALL)


@dataclasses.dataclass(frozen=True)
class Comment:
    """A comment that has its lines to itself."""

    line: int   # the first one's number
    text: str   # all lines in one


def sources(root, folders=FOLDERS):
    """Paths of all sources in the order of their names."""
    found = (path for folder in folders for path in (root / folder).rglob("*") if path.suffix in SUFFIXES)
    return sorted(found)


def documents(root):
    """Markdown files beside the sources."""
    return sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.md"))


def module_of(root, path):
    """The layer of a file: sph for src/sph/model/a.cpp, mpi for mpi/a.cpp; app for a file of src itself."""
    parts = path.relative_to(root).parts
    return parts[1] if parts[0] == "src" and len(parts) > 2 else parts[0]


def comments(text):
    """The comments that have their lines to themselves; neighbouring lines are one."""
    found, first, words = [], 0, []
    for number, line in enumerate([*text.splitlines(), ""], 1):
        if COMMENT.match(line):
            first = first or number
            words.append(line.strip().lstrip("/").strip())
        elif first:
            found.append(Comment(first, " ".join(words)))
            first, words = 0, []
    return found


def code(text, strings=True):
    """The text without comments, and without the text in strings unless `strings`; lines keep their numbers."""
    def blank(found):
        word = found[0]
        if strings and not word.startswith(("//", "/*")):
            return word
        return "\n" * word.count("\n")

    return HIDING.sub(blank, text)


def comment_text(text):
    """Pairs (number, text) of the comment of each line that has one."""
    found = []
    for match in HIDING.finditer(text):
        if match[0].startswith("//"):
            found.append((text.count("\n", 0, match.start()) + 1, match[0]))
    return found
