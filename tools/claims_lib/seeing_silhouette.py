"""Rows of `seeing` on simulated silhouettes."""

from .gtest import run_gtest
from .table import Figure


def sphere(context):
    reports = {n: run_gtest(context, "surface_test", "Silhouette.*", ranks=n) for n in ((1, 3) if context.quick else (1, 2, 3, 4, 8))}
    text = "; ".join(f"{n} ranks: {report.text()}" for n, report in reports.items())
    worst = max(float(report.properties["area_error_percent"]) for report in reports.values())
    return Figure(text, all(report.ok for report in reports.values()) and worst <= 0.2)


def add_rows(table):
    table.row("projected sphere", claim="centred and in a corner, through a pinhole and a distorted lens; the same bits on any ranks",
              asked="area within 0.2 % of the exact outline's")(sphere)
