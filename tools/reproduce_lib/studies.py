"""Studies that several tables and figures use: done once, and they go on where they were stopped."""

import json
import shutil

from claims_lib.run import stamped


def once(folder, name, make):
    """Makes a part of a study, unless it was done before."""
    done = folder / f"{name}.done"
    if not done.exists():
        drop(folder, name)
        make()
        done.touch()


def drop(folder, name):
    """Removes a part, which is made again at its next use."""
    (folder / f"{name}.done").unlink(missing_ok=True)
    shutil.rmtree(folder / name, ignore_errors=True)


def study_folder(context, results, name, inputs, measure):
    """Folder of a study of some name and inputs, and the numbers that measure(folder) returned, now or before; its commands are the entry's either way."""
    folder = stamped(context, results.studies / context.pick("full", "quick", "smallest") / name.replace(" ", "_"), inputs)
    kept = folder / "numbers.json"
    if kept.exists():
        found = json.loads(kept.read_text())
        context.commands += found["commands"]
    else:
        before = len(context.commands)
        found = measure(folder)
        found["commands"] = context.commands[before:]
        kept.write_text(json.dumps(found, indent=2) + "\n")
        results.say(f"{name}: {found['value']:.4g} Pa s, 90 % interval {found['low']:.4g} to {found['high']:.4g}")
    return folder, found
