"""Rows of `viscosity` on the operators: what each form keeps."""

from .gtest import gtest_on_ranks, run_gtest
from .table import Figure

RANKS = 2


def recorded(report, *keys):
    """Numbers that the tests recorded, None for each that is missing."""
    return [float(report.properties[key]) if key in report.properties else None for key in keys]


def symmetry(context):
    report = run_gtest(context, "sph_ranks_test", "ViscousMatrix.SymmetricForms*:ViscousMatrix.ThePrinted*",
                       ranks=RANKS)
    asymmetry, printed = recorded(report, "asymmetry", "printed")
    return Figure(f"largest |C - C^T| over the largest entry {asymmetry:.1e}, the printed form's {printed:.2f}: two liquids of "
                  "1 to 1e4 viscosity, walls, out of order", report.ok and asymmetry <= 1e-15)


def assembled(context):
    return gtest_on_ranks(context, "sph_ranks_test", "ViscousMatrix.IsWhatProductsWithoutAMatrixAre", at_least=1)


def rotation(context):
    names = "ImplicitViscosity.CorrectedFormKeepsRigidRotationOfDiscAndBall:ImplicitViscosity.LaplacianFormStops*"
    report = run_gtest(context, "sph_ranks_test", names, ranks=RANKS)
    lost, *left = recorded(report, "rotation_lost", "disc_01", "disc_1", "disc_100", "ball_01", "ball_1")
    wanted = (0.740, 0.225, 0.0029, 0.692, 0.186)
    near = all(abs(one / exact - 1) <= 0.05 for one, exact in zip(left, wanted))
    return Figure(f"corrected form loses {lost:.1e}; Laplacian form: disc {left[0]:.3f}, {left[1]:.3f}, {left[2]:.5f}, ball "
                  f"{left[3]:.3f}, {left[4]:.3f}", report.ok and lost <= 1e-10 and near)


def momentum(context):
    return gtest_on_ranks(context, "sph_ranks_test", "ImplicitViscosity.EveryFormKeepsMomentum", at_least=1)


def add_rows(table):
    table.row("symmetric forms", claim="|C - C^T| relative, free surfaces, walls and varying viscosity",
              asked="<= 1e-15")(symmetry)
    table.row("assembled", claim="assembled and matrix-free products of every form agree, ranks 1 to 4",
              asked="1e-13")(assembled)
    table.row("rigid rotation", claim="a free disc and ball, one step at nu dt/R^2 = 0.1, 1, 100 (the ball's Laplacian 0.1, 1)",
              asked="full form kept to 1e-10; Laplacian form 0.740 / 0.225 / 0.0029 and 0.692 / 0.186 ± 5 %")(rotation)
    table.row("momentum", claim="linear and angular momentum of a free liquid through a solve, ranks 1 to 4",
              asked="1e-12")(momentum)
