"""Rows of `house` about the C++ sources: folders, words, tags, functions, declarations."""

import collections
import re
import subprocess

from structure_lib import declarations, functions, sources, tags, vocabulary, words

from .table import Figure, Unmeasured

MOST_FILES = 25
SHOWN = 3  # of a list, in a row; all are in the list's file


def listing(context, name, lines):
    """Writes a list beside the report, and returns its path under the tree's root."""
    path = context.scratch.parent / f"{name}.txt"
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("".join(f"{line}\n" for line in lines))
    return str(path.relative_to(context.root)) if path.is_relative_to(context.root) else str(path)


def some(lines, separator=", "):
    lines = [str(line) for line in lines]
    return separator.join(lines[:SHOWN]) + (", ..." if len(lines) > SHOWN else "")


def include_graph(root):
    """Folder: the folders from which its sources include."""
    homes = {}
    for path in sources.sources(root):
        relative = path.relative_to(root).as_posix()
        homes[relative.removeprefix("src/")] = path.parent.relative_to(root).as_posix()
    graph = collections.defaultdict(set)
    for path in sources.sources(root):
        home = path.parent.relative_to(root).as_posix()
        for name in re.findall(r'^#\s*include\s*"([^"]+)"', path.read_text(), re.MULTILINE):
            if homes.get(name, home) != home:
                graph[home].add(homes[name])
    return graph


def reached(graph, start):
    found, to_do = set(), [start]
    while to_do:
        new = graph.get(to_do.pop(), set()) - found
        found |= new
        to_do += new
    return found


def circles(graph):
    """Groups of folders that include each other."""
    below = {folder: reached(graph, folder) for folder in graph}
    around = [folder for folder in graph if folder in below[folder]]
    groups = {frozenset(other for other in around if other in below[folder] and folder in below[other]) for folder in around}
    return sorted(sorted(group) for group in groups)


def rooms(context):
    count = collections.Counter(path.parent.relative_to(context.root).as_posix() for path in sources.sources(context.root))
    crowded = [f"{folder} {files}" for folder, files in count.most_common() if files > MOST_FILES]
    around = [" <-> ".join(group) for group in circles(include_graph(context.root))]
    command = [context.root / "tools/check_structure"]
    context.note(command)
    arrows = [line for line in subprocess.run(command, capture_output=True, text=True).stdout.splitlines() if "may not" in line]
    folder, most = count.most_common(1)[0]
    text = f"{len(count)} folders, at most {most} source files ({folder})"
    for found, fault in ((crowded, f"with more than {MOST_FILES}"), (around, "circles"), (arrows, "arrows up")):
        text += f"; {len(found)} {fault}" + (f": {some(found)}" if found else "")
    return Figure(text, not crowded and not around and not arrows)


def retired_names(context):
    """Names are those of the glossary, which tools/check_structure refuses."""
    known = set(vocabulary.RETIRED)
    found, prose = vocabulary.uses(context.root, known), vocabulary.phrases(context.root)
    left = {line.split(": ")[1].split(",")[0] for line in found}
    where = listing(context, "retired", found + prose)
    text = (f"{len(known)} names known, {len(left)} still in use, {len(found)} times; {len(vocabulary.PHRASES)} phrases known, used {len(prose)} "
            f"times ({where})")
    return Figure(text, not found and not prose)


def openings(context):
    count, found = words.without_a_noun(context.root)
    share = len(found) / max(1, count)
    where = listing(context, "openings", found)
    behind, so = words.behind_code(context.root)
    return Figure(f"{len(found)} of {count}, {100 * share:.1f} % ({where}); behind code, where the name stands before them, {so} of {behind}",
                  share <= 0.02)


def persons(context):
    """A sample for a person to read; personifications.txt beside it, a line a finding, is what that person wrote."""
    found = words.sample(context.root)
    where = listing(context, "comments", found)
    read = context.scratch.parent / "personifications.txt"
    if not read.exists():
        raise Unmeasured(f"{len(found)} comments in {where} wait for a reader, who lists those in which code or liquids know, see, feel or want "
                         "in personifications.txt beside it")
    lines = [line for line in read.read_text().splitlines() if line.strip()]
    return Figure(f"{len(lines)} of {len(found)} comments, read by a person", not lines)


def equation_tags(context):
    found = tags.check(context.root)
    where = listing(context, "tags", found.lines())
    text = (f"{found.rows} rows of tables, {len(found.without_source)} that no source names, {len(found.without_row)} tags of sources without a row, "
            f"{len(found.twice)} tags of two rows ({where})")
    return Figure(text, not found.lines() and found.rows > 0)


def measured_sizes(context):
    try:
        return context.once("sizes", lambda: functions.sizes(context.root))
    except functions.Missing as missing:
        raise Unmeasured(str(missing)) from None


def function_sizes(context):
    sizes = measured_sizes(context)
    long, many = sizes.longer(60), sizes.with_more_parameters(5)
    files, share = sizes.longer_files(400), len(many) / max(1, len(sizes.functions))
    lines = [f"{one.path}:{one.line}: {one.name}, {one.lines} lines" for one in long]
    lines += [f"{path}: {count} lines" for count, path in files]
    lines += [f"{one.path}:{one.line}: {one.name}, {one.parameters} parameters" for one in many]
    where = listing(context, "sizes", lines)
    longest = f" ({sizes.functions[0].name} {sizes.functions[0].lines})" if long else ""
    median, tenth = sizes.quantile(0.5), sizes.quantile(0.9)
    return Figure(f"{len(sizes.functions)} functions: median {median} lines, 90 % {tenth}, {len(long)} over 60{longest}; {len(files)} files over "
                  f"400; {100 * share:.1f} % with more than 5 parameters ({where})",
                  median <= 7 and tenth <= 20 and not long and not files and share <= 0.01)


def public_declarations(context):
    try:
        count = declarations.count(context.root)
    except functions.Missing as missing:
        raise Unmeasured(str(missing)) from None
    where = listing(context, "declarations", count.bare)
    return Figure(f"{len(count.bare)} of {count.all} without, {100 * count.share:.0f} %; {len(count.numbers)} of them numbers without a unit "
                  f"({where})", not count.bare)


def add_rows(table):
    table.row("rooms", claim="folders of src, kokkos, mpi", asked=f"<= {MOST_FILES} source files each, no circle, every arrow down, checked")(rooms)
    table.row("words", claim="tools/check_structure knows the glossary's retired names", asked="finds none")(retired_names)
    table.row("openings", claim="comments with lines to themselves that begin with What, Of, Where, Whether, How or Which", asked="<= 2 %")(openings)
    table.row("persons", claim="200 comments, the same in each call",
              asked="none in which code or liquids know, see, feel or want, by a reader")(persons)
    table.row("tags", claim="rows of equation tables and tags in sources", asked="each has the other; tags unique over the tree")(equation_tags)
    table.row("functions", claim="lengths and parameters, by Universal Ctags",
              asked="median <= 7 lines, 90 % <= 20, none over 60; no file over 400; <= 1 % with more than five parameters")(function_sizes)
    table.row("public declarations", claim="every one in a header has its unit, shape, errors or a sentence", asked="all")(public_declarations)
