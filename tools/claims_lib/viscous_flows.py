"""Rows of `viscosity` on flows with a known answer."""

from .gtest import run_gtest
from .table import Figure

RANKS = 2


def shear_wave(context):
    report = run_gtest(context, "sph_ranks_test", "ImplicitViscosity.ShearWaveDecaysAtNuKSquared", ranks=RANKS)
    rates = [float(report.properties[key]) for key in ("lattice", "disordered")]
    return Figure(f"{rates[0]:.4f} of nu k^2 on a lattice, {rates[1]:.4f} out of order by 0.2 (32 spacings a wave)",
                  report.ok and all(abs(rate - 1) <= 0.02 for rate in rates))


def add_rows(table):
    table.row("shear wave", claim="decay rate of the corrected form", asked="nu k^2 ± 2 %")(shear_wave)
