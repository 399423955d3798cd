"""Rows of `repairs`: the grid's step in time, what the grid must never do, files and input."""

import importlib
import pathlib

from .table import Table

TABLE = Table("repairs")

# Each module beside this one whose name begins with repairs_ adds its rows; the order is that of their names.
for path in sorted(pathlib.Path(__file__).parent.glob("repairs_*.py")):
    importlib.import_module(f"{__package__}.{path.stem}").add_rows(TABLE)
