"""Rows of `ensembles`: searches, sweeps, lanes, journals and clusters."""

import importlib
import pathlib

from .table import Table

TABLE = Table("ensembles")

# Each module beside this one whose name begins with ensembles_ adds its rows; the order is that of their names.
for path in sorted(pathlib.Path(__file__).parent.glob("ensembles_*.py")):
    importlib.import_module(f"{__package__}.{path.stem}").add_rows(TABLE)
