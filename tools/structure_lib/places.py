"""Documents: their lengths, the files that they name, and the list of places in CONTRIBUTING.md."""

import dataclasses
import re

from . import sources

CITED = re.compile(r"`([\w./-]+\.(?:cpp|hpp|h|py|md))`")
LINKED = re.compile(r"\]\(([^)#:\s]+)(?:#[^)]*)?\)")
SECTION = "## Where things are"


def long_documents(root, lines):
    """Pairs (lines, path) of modules' READMEs that are longer than this, the longest first."""
    found = [(len(path.read_text().splitlines()), str(path.relative_to(root))) for path in sources.documents(root) if path.name == "README.md"]
    return sorted((one for one in found if one[0] > lines), reverse=True), len(found)


def all_documents(root):
    skipped = {"build", "out", ".git"}
    return [path for path in sorted(root.rglob("*.md")) if not skipped & set(path.relative_to(root).parts)]


def file_names(root):
    """Where files of each name are, by their paths."""
    skipped = {"build", "out", ".git"}
    found = (path.relative_to(root) for path in root.rglob("*") if path.is_file())
    return ["/" + path.as_posix() for path in found if not skipped & set(path.parts)]


def missing_references(root):
    """file:line: name of each file that a document names or links to and that is not there."""
    names, found = file_names(root), []
    for path in all_documents(root):
        for number, line in enumerate(path.read_text().splitlines(), 1):
            where = f"{path.relative_to(root)}:{number}"
            for name in CITED.findall(line):
                if not (path.parent / name).exists() and not any(each.endswith("/" + name) for each in names):
                    found.append(f"{where}: {name}")
            found += [f"{where}: {target}" for target in LINKED.findall(line) if not (path.parent / target).exists()]
    return found


@dataclasses.dataclass(frozen=True)
class Entry:
    """A row of the list of places: a question, and the way to its line."""

    question: str
    hops: list      # each a text that names a file and, after #, what is in it
    line: int


def entries(root):
    found, inside = [], False
    for number, line in enumerate((root / "CONTRIBUTING.md").read_text().splitlines(), 1):
        if line.startswith("## "):
            inside = line == SECTION
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if inside and len(cells) == 2 and line.startswith("|") and not cells[0].startswith(("-", "question")):
            found.append(Entry(cells[0], [hop.strip() for hop in cells[1].split("→")], number))
    return found


def faults(root, entry):
    """What is wrong with an entry: too many hops, files that are not there, symbols that a file of their hop does not have."""
    found = [f"{len(entry.hops)} hops"] if len(entry.hops) > 3 else []
    names = file_names(root)
    for hop in entry.hops:
        words = re.findall(r"`([^`]+)`", hop)
        files = [word for word in words if re.search(r"\.\w+$", word)]
        paths = [root / each.lstrip("/") for file in files for each in names if each.endswith("/" + file)]
        found += [f"no file {file}" for file in files if not any(each.endswith("/" + file) for each in names)]
        text = "\n".join(path.read_text() for path in paths)
        if not files:
            found.append(f"no file in {hop!r}")
        symbols = [word for word in words if word not in files]
        found += [f"no {word} in {', '.join(files)}" for word in symbols if not re.search(rf"(?<!\w){re.escape(word)}(?!\w)", text)]
    return [f"CONTRIBUTING.md:{entry.line}: {fault}" for fault in found]
