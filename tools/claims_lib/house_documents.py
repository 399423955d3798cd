"""Rows of `house` about documents: READMEs, and the way to a line that answers a question."""

from structure_lib import places

from .house_sources import listing, some
from .table import Figure

LONGEST = 120
QUESTIONS = 10


def readmes(context):
    long, count = places.long_documents(context.root, LONGEST)
    missing = places.missing_references(context.root)
    where = listing(context, "documents", [f"{path}: {lines} lines" for lines, path in long] + missing)
    longest = some(f"{path} {lines}" for lines, path in long)
    return Figure(f"{count} READMEs of modules, {len(long)} longer{': ' + longest if long else ''}; {len(missing)} references to files that are not "
                  f"there{': ' + some(missing) if missing else ''} ({where})", not long and not missing and count > 0)


def stranger(context):
    """Each entry names its files, and symbols that are in them, in at most three hops."""
    entries = places.entries(context.root)
    faults = [fault for entry in entries for fault in places.faults(context.root, entry)]
    where = listing(context, "places", faults)
    hops = max((len(entry.hops) for entry in entries), default=0)
    return Figure(f"{len(entries)} questions, at most {hops} hops, {len(faults)} faults{': ' + some(faults, '; ') if faults else ''} ({where})",
                  len(entries) >= QUESTIONS and not faults)


def add_rows(table):
    table.row("READMEs", claim="READMEs of modules, and files that documents name", asked=f"<= {LONGEST} lines; all files are there")(readmes)
    table.row("a stranger's test", claim=f"{QUESTIONS} questions of a newcomer, as CONTRIBUTING lists their answers",
              asked="from README to line in at most three hops, files and symbols are there")(stranger)
