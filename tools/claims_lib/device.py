"""Rows of `device`: one solve layer in kernels, so that a step runs where the particles are."""

from . import device_answers, device_sources, device_solves, device_steps
from .table import Table

TABLE = Table("device")

# The order is that of the table.
for rows in (device_sources, device_solves, device_steps, device_answers):
    rows.add_rows(TABLE)
