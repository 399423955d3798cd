#!/usr/bin/env python3
"""The interface of two liquids of densities 10 to 1 swings with the frequency of linear theory.

usage: interfacial_wave_test.py PROGRAM MPIEXEC RANKS
"""
import os
import unittest

import numpy

import tank_at_rest
from tank_at_rest import HERE, Workplace

LENGTH, DEPTH = 0.4, 0.2  # of the tank, and of each liquid [m]
ALONG, DOWN = 1.46597, 9.69984  # gravity [m/s2]
LIGHT, HEAVY = 100.0, 1000.0
WAVE_NUMBER = numpy.pi / LENGTH
# omega^2 = g k (rho1 - rho2) / (rho1 coth k h1 + rho2 coth k h2), lids above and below
OMEGA = numpy.sqrt(DOWN * WAVE_NUMBER * (HEAVY - LIGHT) * numpy.tanh(WAVE_NUMBER * DEPTH) / (HEAVY + LIGHT))
# How far the heavy liquid's centre moves for a slant of ALONG / DOWN of the interface.
SHIFT = ALONG / DOWN * LENGTH ** 2 / (12 * DEPTH)


def fit(time, place):
    """The mean, frequency, and amplitude of a damped oscillation, and the root mean square of what is left."""
    best = None
    for omega in numpy.linspace(0.5 * OMEGA, 1.6 * OMEGA, 221):
        for damping in numpy.linspace(0, 3, 16):
            envelope = numpy.exp(-damping * time)
            terms = numpy.stack([numpy.ones_like(time), envelope * numpy.cos(omega * time),
                                 envelope * numpy.sin(omega * time)], axis=1)
            factors = numpy.linalg.lstsq(terms, place, rcond=None)[0]
            left = numpy.sqrt(numpy.mean((terms @ factors - place) ** 2))
            if best is None or left < best[3]:
                best = factors[0], omega, numpy.hypot(*factors[1:]), left
    return best


class InterfacialWave(Workplace):
    def test_swings_with_the_frequency_and_the_reach_of_linear_theory(self):
        self.run_scene(os.path.join(HERE, "scenes", "interfacial_wave.yaml"), "run", tank_at_rest.ranks, {})
        frames = [self.frame("run", number) for number in range(61)]
        time = numpy.array([frame["time"] for frame in frames])
        place = numpy.array([frame["position"][frame["liquid"] == 1, 0].mean() for frame in frames])
        mean, omega, amplitude, left = fit(time, place)
        self.assertLess(left, 0.03 * SHIFT)  # the third mode has 1/81 of the first one's share in the centre
        # Measured 2.5 % too fast, as with spacings of 1.25 cm, and 0.8 % with 1 cm: first order, and the slant's own.
        self.assertAlmostEqual(omega / OMEGA, 1, delta=0.05)
        self.assertAlmostEqual((mean - LENGTH / 2) / SHIFT, 1, delta=0.05)  # measured 1.02
        self.assertAlmostEqual(amplitude / SHIFT, 1, delta=0.1)  # from level; measured 0.98


if __name__ == "__main__":
    tank_at_rest.main(__doc__)
