"""Rows of `seeing`: surfaces, cameras, calibration, silhouettes, films, and the proof of the unified step."""

import importlib
import pathlib

from .table import Table

TABLE = Table("seeing")

# Each module beside this one whose name begins with seeing_ adds its rows; the order is that of their names.
for path in sorted(pathlib.Path(__file__).parent.glob("seeing_*.py")):
    importlib.import_module(f"{__package__}.{path.stem}").add_rows(TABLE)
