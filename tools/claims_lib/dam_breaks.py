"""Published dam breaks in a plane, and how far the front and the height of a run are from them."""

import dataclasses
import math

import numpy

from .table import Figure

GRAVITY = 9.81  # [m/s2]


@dataclasses.dataclass(frozen=True)
class Series:
    """What was measured: values over times, both without units."""

    times: tuple
    values: tuple


# Martin and Moyce (1952), column of width a and height 2 a, as tabulated in the literature. Front in a over
# T = t sqrt(2 g / a); the last points are digitised from a figure.
MARTIN_MOYCE_WIDTH = 0.05715  # [m]
MARTIN_MOYCE_FRONT = Series(
    (.41, .84, 1.19, 1.43, 1.63, 1.83, 1.98, 2.20, 2.32, 2.51, 2.65, 2.83, 2.98, 3.11, 3.33, 4.034, 5.091, 6.306),
    (1.11, 1.22, 1.44, 1.67, 1.89, 2.11, 2.33, 2.56, 2.78, 3.00, 3.22, 3.44, 3.67, 3.89, 4.11, 4.944, 6.980, 8.966))
# Height at the wall in 2 a, over tau = t sqrt(g / a).
MARTIN_MOYCE_HEIGHT = Series(
    (.56, .77, .93, 1.08, 1.28, 1.46, 1.66, 1.84, 2.00, 2.21, 2.45, 2.70, 3.06, 3.44, 4.20, 5.25),
    (.94, .89, .83, .78, .72, .67, .61, .56, .50, .44, .39, .33, .28, .22, .17, .11))

# Koshizuka and Oka (1996), column of width L and height 2 L. Front in L over t sqrt(2 g / L).
KOSHIZUKA_OKA_WIDTH = 0.146  # [m]
KOSHIZUKA_OKA_FRONT = Series((.381, .769, 1.153, 1.537, 1.935, 2.323, 2.719, 3.096),
                             (1.111, 1.252, 1.505, 1.892, 2.241, 2.615, 3.003, 3.624))


def front_times(seconds, width):
    return seconds * math.sqrt(2 * GRAVITY / width)


def height_times(seconds, width):
    return seconds * math.sqrt(GRAVITY / width)


def deviations(series, times, values, *, shift=0.0, until=math.inf):
    """Relative deviations of a run from the points up to a time; shift: what the run's clock is ahead by."""
    wanted = numpy.array(series.times)
    chosen = wanted <= until
    at = wanted[chosen] + shift
    if at.max() > times[-1]:
        raise ValueError(f"the run ends at {times[-1]:.3f}, before the point at {at.max():.3f}")
    return numpy.interp(at, times, values) / numpy.array(series.values)[chosen] - 1


def best_shift(series, times, values, largest, until=math.inf):
    """The shift, at most this large, with the least worst deviation; returns it and the deviations."""
    shifts = numpy.round(numpy.arange(-largest, largest + 0.005, 0.01), 2)
    tried = [(shift, deviations(series, times, values, shift=shift, until=until)) for shift in shifts]
    return min(tried, key=lambda pair: (numpy.abs(pair[1]).max(), abs(pair[0])))


def span(relative):
    """Deviations as text: their range in percent."""
    return f"{100 * relative.min():+.1f} .. {100 * relative.max():+.1f} %"


def worst(relative):
    return float(numpy.abs(relative).max())


def martin_moyce(time, front, height, *, front_within, height_within):
    """The figure of a run: front in widths, height in first heights."""
    clock = front_times(time, MARTIN_MOYCE_WIDTH)
    shift, ahead = best_shift(MARTIN_MOYCE_FRONT, clock, front, 0.15, until=4.04)
    later = deviations(MARTIN_MOYCE_FRONT, clock, front, shift=shift)[len(ahead):]
    higher = deviations(MARTIN_MOYCE_HEIGHT, height_times(time, MARTIN_MOYCE_WIDTH), height)
    last = numpy.array(MARTIN_MOYCE_HEIGHT.values) * higher
    return Figure(f"front {span(ahead)} at shift {shift:+.2f} ({len(ahead)} points; later ones {span(later)}); height {span(higher)} "
                  f"({len(higher)} points, no shift; of the first height {span(last)})",
                  worst(ahead) <= front_within and worst(higher) <= height_within)


def koshizuka_oka(time, front, *, within):
    """The figure of a run: front in widths."""
    clock = front_times(time, KOSHIZUKA_OKA_WIDTH)
    plain = deviations(KOSHIZUKA_OKA_FRONT, clock, front)
    shift, shifted = best_shift(KOSHIZUKA_OKA_FRONT, clock, front, 0.05)
    return Figure(f"{span(shifted)} at shift {shift:+.2f} ({len(plain)} points; without a shift {span(plain)})", worst(shifted) <= within)
