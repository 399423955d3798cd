"""Rows of `sph`: impacts, rest, closed flows and drops of SPH, and contact of bodies."""

from . import sph_contact, sph_cost, sph_drops, sph_flows, sph_impacts, sph_rest
from .table import Table

TABLE = Table("sph")

# The order is that of the table; another module with rows stands here as these do.
for rows in (sph_impacts, sph_rest, sph_flows, sph_drops, sph_contact, sph_cost):
    rows.add_rows(TABLE)
