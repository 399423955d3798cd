"""Rows of `ground`: hybrid incompressible SPH from a scene file to a picture, on any number of ranks."""

from .gtest import run_gtest
from .table import Figure, Table

TABLE = Table("ground")


@TABLE.row("golden numbers", claim="kernel sums on a lattice and at a single-layer wall are the reference's",
           asked="4 digits")
def golden_numbers(context):
    report = run_gtest(context, "golden_test", "*")
    return Figure(report.text(), report.ok)
