"""One small dam break around a body, run on several numbers of ranks and compared particle by particle."""

import numpy

STEPS, STEP = 50, 0.001  # [s]


def spacing(context):
    """Of the particles [m]: 3,500 of them, or 28,000."""
    return 0.025 if context.quick else 0.0125


def overrides(context, **more):
    """The liquid runs into the body within the run; the solver's tolerance leaves round-off alone."""
    return {
        "domain.spacing": spacing(context),
        "bodies.post.shape.box.min": "[0.4, 0.15, 0]",
        "bodies.post.shape.box.max": "[0.5, 0.25, 0.35]",
        "liquids.water.velocity": "[2, 0, 0]",
        "time.end": STEPS * STEP,
        "time.rule": "fixed",
        "time.step": STEP,
        "method.pressure.stop": "residual",
        "method.pressure.residual": "1e-12",
        "output.double_precision": "true",
        "output.fields": "[velocity, pressure, role]",
        "output.interval": STEPS * STEP,
        "output.checkpoint_interval": 0,
        "max_lost_fraction": 0,
        **more,
    }


def largest_move(one, other):
    """Largest distance of a particle between two frames [m]; infinite when they hold different particles."""
    if not numpy.array_equal(one["id"], other["id"]):
        return numpy.inf
    return float(numpy.linalg.norm(one["position"] - other["position"], axis=1).max(initial=0))


def differing_roles(one, other):
    return int((one["role"] != other["role"]).sum())


def bitwise_equal(one, other):
    return one.keys() == other.keys() and all(one[name].tobytes() == other[name].tobytes() for name in one)
