"""Rows of `grid` on inlets, outlets and viscosities by shear rate."""

from .gtest import gtest_on_ranks


def thinning(context):
    """The tests hold each to its bound."""
    return gtest_on_ranks(context, "grid_flow_test", "Channel.*", at_least=5)


def inlets(context):
    return gtest_on_ranks(context, "grid_flow_test", "Inlet.*", at_least=4)


def add_rows(table):
    table.row("shear rate", claim="channels of power-law liquids and of a Bingham fluid, 20 cells wide, ranks 1 to 4",
              asked="± 2 %, ± 3 %; 1e-7 m")(thinning)
    table.row("inlets", claim="volume by time, no gap behind an opening, a rope held, ranks 1 to 4",
              asked="half a layer; uniform; 1e-6 m")(inlets)
