"""Tags of equations: each row of a module's equation tables has its place in a source of the module, and the other way round."""

import collections
import dataclasses
import re

from . import sources

# (S1), (sph.S4t): the tag in a comment. (S1)-(S3) names those in between as well.
TAG = r"(?:[a-z]+\.)?[A-Z]{1,2}\d{0,2}[a-z]?"
CITED = re.compile(rf"\(({TAG}(?:(?:, | and ){TAG})*)\)")
RANGE = re.compile(rf"\(({TAG})\)?\s*(?:-|–|to)\s*\(?({TAG})\)")


@dataclasses.dataclass(frozen=True)
class Row:
    """A row of an equation table."""

    tag: str
    module: str
    place: str  # file:line


def full_name(tag, module):
    return tag if "." in tag else f"{module}.{tag}"


def table_rows(root):
    """Rows of all tables in documents beside the sources whose first column is headed "tag"."""
    rows = []
    for path in sources.documents(root):
        module, inside = sources.module_of(root, path), False
        for number, line in enumerate(path.read_text().splitlines(), 1):
            cells = [cell.strip() for cell in line.split("|")]
            if len(cells) < 3 or cells[0]:
                inside = False
            elif cells[1] == "tag":
                inside = True
            elif inside:
                place = f"{path.relative_to(root)}:{number}"
                rows += [Row(tag, module, place) for tag in re.findall(rf"(?<![\w.]){TAG}(?![\w.])", cells[1])]
    return rows


def between(first, last):
    """S2 for S1 and S3: what a range of tags skips."""
    one, other = re.fullmatch(r"(.*?)(\d+)", first), re.fullmatch(r"(.*?)(\d+)", last)
    if not one or not other or one[1] != other[1].split(".")[-1] and one[1] != other[1]:
        return []
    return [f"{one[1]}{number}" for number in range(int(one[2]) + 1, int(other[2]))]


def cited_tags(comment):
    """Tags that a comment names in parentheses."""
    found = [tag for group in CITED.findall(comment) for tag in re.split(r", | and ", group)]
    for first, last in RANGE.findall(comment):
        found += [first, last, *between(first, last)]
    return found


def citations(root):
    """Full name of a tag: its places file:line in the sources' comments."""
    places = collections.defaultdict(list)
    for path in sources.sources(root):
        module = sources.module_of(root, path)
        for number, comment in sources.comment_text(path.read_text()):
            for tag in sorted(set(cited_tags(comment))):
                places[full_name(tag, module)].append(f"{path.relative_to(root)}:{number}")
    return places


@dataclasses.dataclass(frozen=True)
class Findings:
    rows: int
    without_source: list  # rows of tables that no source names
    without_row: list     # tags in sources that no table has
    twice: list           # tags that two rows have, of one module or of several

    def lines(self):
        kinds = (("no source names", self.without_source), ("no table has", self.without_row), ("twice", self.twice))
        return [f"{kind} {line}" for kind, lines in kinds for line in lines]


def families(rows):
    """(P) stands for (P1), (P2) and so on of the same module."""
    return {full_name(row.tag.rstrip("0123456789"), row.module) for row in rows if row.tag[-1].isdigit()}


def check(root):
    rows, places = table_rows(root), citations(root)
    known = {full_name(row.tag, row.module) for row in rows} | families(rows)
    by_tag = collections.defaultdict(list)
    for row in rows:
        by_tag[row.tag].append(f"{row.place} ({row.module})")
    return Findings(
        rows=len(rows),
        without_source=[f"({row.tag}) of {row.place}" for row in rows if full_name(row.tag, row.module) not in places],
        without_row=[f"({name}), {len(where)} times, first {where[0]}" for name, where in sorted(places.items()) if name not in known],
        twice=[f"({tag}): {', '.join(where)}" for tag, where in sorted(by_tag.items()) if len(where) > 1])
