"""Rows of `viscosity`: implicit viscosity of the full stress, beside what it replaces."""

from . import coiling, viscous_flows, viscous_operators, viscous_peer, viscous_solve, viscous_walls
from .table import Table

TABLE = Table("viscosity")

# The order is that of the table; another module with rows stands here as these do.
for rows in (viscous_operators, viscous_flows, viscous_walls, viscous_solve, viscous_peer, coiling):
    rows.add_rows(TABLE)
