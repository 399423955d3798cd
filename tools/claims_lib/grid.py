"""Rows of `grid`: chapter 5, viscous liquids and bodies on a MAC grid with particles."""

from . import grid_bodies, grid_flows, grid_inflow, grid_peer, grid_solves
from .table import Table

TABLE = Table("grid")

# The order is that of the table.
for rows in (grid_flows, grid_inflow, grid_bodies, grid_solves, grid_peer):
    rows.add_rows(TABLE)
