"""How comments begin."""

import random
import re

from . import sources

# A comment begins, after its tag, with its noun or verb; those that these words open leave the noun out.
OPENINGS = re.compile(r"(?:\([\w.-]+\)[,:]? )*(What|Of|Where|Whether|How|Which)\b")
SAMPLE = 200
SEED = 27


def located_comments(root):
    """Pairs (file:line, text) of all comments that have their lines to themselves."""
    for path in sources.sources(root):
        for comment in sources.comments(path.read_text()):
            yield f"{path.relative_to(root)}:{comment.line}", comment.text


def without_a_noun(root):
    """Number of comments, and those that begin with such a word."""
    found = list(located_comments(root))
    return len(found), [f"{place}: {text}" for place, text in found if OPENINGS.match(text)]


def behind_code(root):
    """Number of comments behind code, and how many of them begin so, with a small letter as a rule: "double dt; // of the step [s]"."""
    count, found = 0, 0
    for path in sources.sources(root):
        text = path.read_text()
        alone = {number for number, line in enumerate(text.splitlines(), 1) if sources.COMMENT.match(line)}
        for number, comment in sources.comment_text(text):
            if number not in alone:
                count += 1
                found += bool(OPENINGS.match(comment.lstrip("/ ").capitalize()))
    return count, found


def sample(root):
    """Comments for a person to read, the same for the same tree."""
    found = list(located_comments(root))
    chosen = sorted(random.Random(SEED).sample(range(len(found)), min(SAMPLE, len(found))))
    return [f"{found[index][0]}: {found[index][1]}" for index in chosen]
