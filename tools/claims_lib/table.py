"""What a row of a claim is, and how a table of rows is run and reported."""

import dataclasses
import enum
import json
import pathlib
import random
import shlex
import sys
import time


class Status(enum.Enum):
    OK = "ok"
    SHORT = "short"
    NOT_MEASURED = "not measured"


class Unmeasured(Exception):
    """This machine or call lacks what the row needs, such as a peer's program."""


class CommandFailed(Exception):
    """A command behind a row ended otherwise than the row requires."""


class TimedOut(CommandFailed):
    """A command behind a row has not ended within its time."""


@dataclasses.dataclass(frozen=True)
class Figure:
    """What a row measured: the figure as text, and whether it is within the requirement."""

    measured: str
    ok: bool


@dataclasses.dataclass(frozen=True)
class Row:
    name: str
    claim: str
    asked: str
    measure: object  # function of a Context, returns a Figure


class Table:
    """The rows of one issue, in the order in which they are declared."""

    def __init__(self, name, built=True):
        self.name = name
        self.built = built  # its rows need a build folder; rows of other tables declare it
        self.rows = []

    def row(self, name, *, claim, asked):
        if any(row.name == name for row in self.rows):
            raise ValueError(f"two rows named {name!r} in {self.name}")

        def declare(measure):
            self.rows.append(Row(name, claim, asked, measure))
            return measure

        return declare


@dataclasses.dataclass
class Context:
    """What a row is run with. Every command it starts is noted and becomes part of the row's line."""

    root: pathlib.Path
    build: pathlib.Path
    scratch: pathlib.Path
    quick: bool = False
    smallest: bool = False # of reproductions, quick too: as small as it runs, for tests
    peers: dict = dataclasses.field(default_factory=dict)
    commands: list = dataclasses.field(default_factory=list)
    kept: dict = dataclasses.field(default_factory=dict)

    def pick(self, full, quick, smallest):
        """What fits the size of the call."""
        return smallest if self.smallest else quick if self.quick else full

    def once(self, key, measure):
        """What measure() returned, for rows on the same runs; measured once in a call of tools/claims."""
        if key not in self.kept:
            self.kept[key] = measure()
        return self.kept[key]

    def sample(self, cases, quick, full=None):
        """All cases, or `full` of them; with --quick `quick` of them: the same sample in each call."""
        cases = list(cases)
        count = quick if self.quick else full
        return cases if count is None else random.Random(27).sample(cases, min(count, len(cases)))

    def note(self, command):
        self.commands.append(shlex.join(str(word) for word in command))

    def peer(self, name):
        """Path of a peer's program, given as --peer NAME=PATH."""
        if name not in self.peers:
            raise Unmeasured(f"needs --peer {name}=PATH")
        return self.peers[name]


def measure(row, context):
    """Runs one row; whatever goes wrong is a row that falls short, never the end of the table."""
    context.commands = []
    start = time.monotonic()
    try:
        figure = row.measure(context)
        status, measured = (Status.OK if figure.ok else Status.SHORT), figure.measured
    except Unmeasured as reason:
        status, measured = Status.NOT_MEASURED, str(reason)
    except Exception as error:
        status, measured = Status.SHORT, f"{type(error).__name__}: {error}"
    return {
        "row": row.name,
        "claim": row.claim,
        "asked": row.asked,
        "measured": measured,
        "status": status.value,
        "command": " && ".join(context.commands),
        "seconds": round(time.monotonic() - start, 2),
    }


def line(result):
    return " | ".join(result[key] for key in ("row", "claim", "asked", "measured", "status", "command"))


def count(results, status):
    return sum(result["status"] == status.value for result in results)


def run(table, rows, context, report, out=sys.stdout):
    """Measures the rows, prints a line each and the totals, writes the report; True if none falls short."""
    results = []
    for row in rows:
        results.append(measure(row, context))
        print(line(results[-1]), file=out, flush=True)
    report.parent.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"claims": table.name, "quick": context.quick, "rows": results}, indent=2)
    temporary = report.with_name(report.name + ".part")
    temporary.write_text(text + "\n")
    temporary.replace(report)
    print(f"written to {report}", file=out)
    unmeasured = count(results, Status.NOT_MEASURED)
    if unmeasured:
        print(f"{unmeasured} not measured", file=out)
    short = count(results, Status.SHORT)
    print(f"{count(results, Status.OK)} passed, {short} failed", file=out)
    return short == 0
